#pragma once

#include <vector>

#include "base/result.h"
#include "detection/class_table.h"
#include "detection/dnn_options.h"
#include "detection/letterbox.h"
#include "detection/tensor.h"
#include "segmentation/detections.h"

namespace vismap {

// From the numbers that come out of a network to detections. Plain functions on plain buffers.

/// What a YOLO segmentation network found in an image that was laid into its input by `letterbox`:
/// sigmoid(coefficients x prototypes), cut to the box, brought to the image's size, above the mask
/// threshold (Bolya 2019, YOLACT). Strongest first; empty masks and classes that are to be dropped
/// are left out. Fails with the shapes expected and found.
Result<std::vector<Detection>> YoloDetections(std::vector<Tensor> outputs,
                                              const Letterbox& letterbox, const ClassTable& classes,
                                              const DnnDetectorOptions& options);

/// The same for TensorFlow's Mask R-CNN, which has suppressed overlaps itself: `found` 1x1xNx7 with
/// rows (image, class, score, left, top, right, bottom; edges in [0, 1] of the image), `masks`
/// NxCLASSESxHxW, each class's chance in [0, 1] over the box.
Result<std::vector<Detection>> MaskRcnnDetections(const Tensor& found, const Tensor& masks,
                                                  int image_width, int image_height,
                                                  const ClassTable& classes,
                                                  const DnnDetectorOptions& options);

}  // namespace vismap
