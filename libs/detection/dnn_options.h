#pragma once

#include <array>
#include <string>

#include "base/enum_names.h"

namespace vismap {

/// The kind of a network's outputs, see read_outputs.h.
enum class DnnModelKind {
  kAuto,      ///< by the file name: .onnx is kYoloSeg, .pb is kMaskRcnn
  kYoloSeg,   ///< YOLOv5, v8 or 11 with a segmentation head
  kMaskRcnn,  ///< TensorFlow's Mask R-CNN as OpenCV runs it
};

inline constexpr auto NamesOf(DnnModelKind) {
  return std::to_array<EnumName<DnnModelKind>>({{"BY_NAME", DnnModelKind::kAuto},
                                                {"YOLO_SEG", DnnModelKind::kYoloSeg},
                                                {"MASK_RCNN", DnnModelKind::kMaskRcnn}});
}

/// Which network to use, and which of its detections to keep.
struct DnnDetectorOptions {
  std::string model;  ///< file .onnx, or a frozen graph .pb of TensorFlow; empty = none
  std::string graph;  ///< for TensorFlow: the file .pbtxt of the graph
  DnnModelKind kind = DnnModelKind::kAuto;
  /// Side of the network's square input [px]; 0 = the size that the model states, or that of the
  /// image if the model accepts any size.
  int input_size_px = 0;
  double min_score = 0.25;      ///< detections below are dropped (default of Ultralytics)
  double nms_iou = 0.7;         ///< largest IoU of two boxes of a class (default of Ultralytics)
  double mask_threshold = 0.5;  ///< pixels above it are inside a mask (He 2017)
  int max_detections = 100;     ///< at most so many per frame, the best ones (COCO's evaluation)
  std::string class_names;      ///< file with the classes, see LoadClassTable; empty = COCO
  int threads = 0;              ///< number of threads of the network; 0 = all processors
};

}  // namespace vismap
