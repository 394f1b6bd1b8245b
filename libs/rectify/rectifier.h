#pragma once

#include <deque>
#include <memory>
#include <string>

#include "base/result.h"
#include "geometry/frame.h"

namespace vismap {

struct RectifyTables;

/// Turns frames as cameras take them into frames of ideal cameras: colour and depth without
/// distortion, and depth at the pixels of the colour image. All programs that use frames do this
/// once, where they read them. The tables of a camera are computed with its first frame and kept,
/// of the latest cameras in at most 128 MB. Not for several threads at once; its loops are
/// parallel, with the same result for any number of threads.
class Rectifier {
 public:
  Rectifier();
  ~Rectifier();

  /// The frame of the ideal camera frame.header.camera: depth in the steps of the frame (or in
  /// metres, if the frame has metres), colour as JPEG. A frame of an ideal camera is returned
  /// unchanged. Colour that cannot be decoded is left out, see `color_problem`. Fails when a
  /// distortion folds within the image, and when depth or colour do not have the sizes of their
  /// cameras.
  Result<SensorFrame> Rectify(SensorFrame frame);

  /// Rectify, then DecodeFrame.
  Result<RgbdFrame> Decode(const SensorFrame& frame);

  /// Only the colour of a frame, HxW of header.camera. Fails also when it cannot be decoded, and
  /// when there is none.
  Result<Image<Rgb8>> DecodeColor(const SensorFrame& frame);

 private:
  Result<std::shared_ptr<const RectifyTables>> TablesOf(const SensorFrame& frame);

  std::deque<std::shared_ptr<const RectifyTables>> tables_;  // those of the latest camera last
};

}  // namespace vismap
