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

// The room `detection` runs networks that find object instances in colour images. In the paper,
// this is Mask R-CNN (Grinvald 2019, Sec. III-B). Only network.cc uses OpenCV's dnn module. The
// room `segmentation` uses the detections; the room `datasets` reads recorded ones.

/// The size of a network's input [px]; 0 = that of the image.
struct InputSize {
  int width = 0, height = 0;
};

/// A network with the conversion of its input image and of its outputs. Only one thread may use it
/// at a time. The same image gives the same detections.
class DnnDetector {
 public:
  /// Loads the model and runs it once, so that outputs of a wrong shape are found here. Fails,
  /// naming the file, with what was expected and found.
  static Result<std::unique_ptr<DnnDetector>> Load(const DnnDetectorOptions& options);

  /// The objects that the network finds in the colour image of a frame, highest score first.
  /// `color` must not be empty. Fails if the network cannot be run.
  Result<DetectionSet> Detect(const Image<Rgb8>& color, const FrameHeader& header);

 private:
  DnnDetector(const DnnDetectorOptions& options, Network network, ClassTable classes,
              InputSize input);
  Result<std::vector<Detection>> FindInstances(const Image<Rgb8>& color);
  Letterbox FitInput(const Image<Rgb8>& color) const;

  DnnDetectorOptions options_;
  Network network_;
  ClassTable classes_;
  InputSize input_;
};

}  // namespace vismap
