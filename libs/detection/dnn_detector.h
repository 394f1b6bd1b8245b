#pragma once

#include <memory>

#include "base/result.h"
#include "detection/class_table.h"
#include "detection/dnn_options.h"
#include "detection/letterbox.h"
#include "detection/network.h"
#include "geometry/frame.h"
#include "segmentation/detections.h"

namespace vismap {

// What lives in this room: networks that find object instances in colour images (the detector of
// the paper's Sec. III-B, which was Mask R-CNN). OpenCV's dnn is used in network.cc only. What does
// not live here: what becomes of the detections (segmentation), recorded ones (datasets).

/// Of a network's input [px]; 0 = that of the image.
struct InputSize {
  int width = 0, height = 0;
};

/// A network with what belongs to it: how an image goes in, and how its outputs are read.
/// For one thread at a time. The same image gives the same detections.
class DnnDetector {
 public:
  /// Loads the model and runs it once, so that outputs of a wrong shape show at once. Fails naming
  /// the file, with what was expected and found.
  static Result<std::unique_ptr<DnnDetector>> Load(const DnnDetectorOptions& options);

  /// What the network sees in the colour image of the frame with this header, strongest first.
  /// `color` must not be empty. Fails when the network cannot be run.
  Result<DetectionSet> Detect(const Image<Rgb8>& color, const FrameHeader& header);

 private:
  DnnDetector(const DnnDetectorOptions& options, Network network, ClassTable classes,
              InputSize input);
  Result<std::vector<Detection>> Look(const Image<Rgb8>& color);
  Letterbox FitInput(const Image<Rgb8>& color) const;

  DnnDetectorOptions options_;
  Network network_;
  ClassTable classes_;
  InputSize input_;
};

}  // namespace vismap
