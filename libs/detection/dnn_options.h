#pragma once

#include <string>

namespace vismap {

/// What comes out of a network, see yolo_head.h and mask_rcnn.h.
enum class DnnModelKind {
  kAuto,      ///< by the file's name: .onnx is kYoloSeg, .pb is kMaskRcnn
  kYoloSeg,   ///< YOLOv5, v8 or 11 with a segmentation head
  kMaskRcnn,  ///< TensorFlow's Mask R-CNN as OpenCV runs it
};

/// A network that finds object instances, and what of its answers counts.
struct DnnDetectorOptions {
  std::string model;  ///< .onnx, or TensorFlow's frozen graph .pb; empty = none
  std::string graph;  ///< TensorFlow: the graph's text .pbtxt
  DnnModelKind kind = DnnModelKind::kAuto;
  /// Longer side of the network's input [px]; 0 = as the model says, or that of the image when the
  /// model takes any.
  int input_size = 0;
  double min_score = 0.25;  ///< weaker detections are dropped (default of Ultralytics)
  double nms_iou = 0.7;     ///< of two boxes of a class that overlap more, the weaker goes (same)
  double mask_threshold = 0.5;  ///< pixels above are inside a mask (He 2017)
  int max_detections = 100;     ///< per frame, the strongest (COCO's evaluation)
  std::string class_names;      ///< file, see LoadClassTable; empty = COCO
  int threads = 0;              ///< of the network; 0 = all processors
};

}  // namespace vismap
