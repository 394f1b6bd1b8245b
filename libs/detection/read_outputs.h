#pragma once

#include <vector>

#include "base/result.h"
#include "detection/class_table.h"
#include "detection/dnn_options.h"
#include "detection/letterbox.h"
#include "detection/tensor.h"
#include "segmentation/detections.h"

namespace vismap {

// Functions that convert the outputs of a network to detections.

/// The detections of a YOLO segmentation network in an image that `letterbox` placed in its input.
/// A mask is sigmoid(coefficients x prototypes) > mask_threshold, resized to the image and cut to
/// the box (Bolya 2019, YOLACT). The highest score is first. Empty masks and dropped classes are
/// left out. Fails with the shapes expected and found.
Result<std::vector<Detection>> YoloDetections(std::vector<Tensor> outputs,
                                              const Letterbox& letterbox, const ClassTable& classes,
                                              const DnnDetectorOptions& options);

/// The same for Mask R-CNN of TensorFlow. `found` is 1x1xNx7 with rows (image, class, score, left,
/// top, right, bottom), whose edges are in [0, 1] of the image. `masks` is NxCLASSESxHxW:
/// probabilities in [0, 1] on a grid over the box, for each class.
Result<std::vector<Detection>> MaskRcnnDetections(const Tensor& found, const Tensor& masks,
                                                  int image_width, int image_height,
                                                  const ClassTable& classes,
                                                  const DnnDetectorOptions& options);

}  // namespace vismap
