#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geometry/image.h"

namespace vismap {

/// The image as a WebP file with losses; `quality` in [1, 100]. Width and height must be
/// 1..kMaxWebpSide.
std::vector<uint8_t> EncodeWebp(const Image<Rgb8>& image, int quality);
inline constexpr int kMaxWebpSide = 16383;  ///< [px]

/// Collects pictures of one size as an animated WebP that repeats for ever.
class WebpAnimation {
 public:
  /// `frame_ms`: how long each picture is shown [ms].
  WebpAnimation(int width, int height, int frame_ms, int quality);
  /// Throws std::logic_error when the image has another size.
  void Add(const Image<Rgb8>& image);
  /// The file. There must be a picture.
  std::vector<uint8_t> Finish() const;

 private:
  int width_, height_, frame_ms_, quality_;
  std::vector<uint8_t> frames_;  // their ANMF chunks
};

}  // namespace vismap
