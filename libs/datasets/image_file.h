#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "base/result.h"
#include "geometry/camera.h"
#include "geometry/image.h"

namespace vismap {

/// What the first bytes of an image file say of it.
struct ImageFileInfo {
  enum class Kind { kPng, kJpeg } kind = Kind::kPng;
  int width = 0;
  int height = 0;
  int bits = 8;       ///< per channel
  bool grey = false;  ///< one channel without palette
};

/// Reads PNG and JPEG headers; fails on anything else and on more than 16384 px each way.
Result<ImageFileInfo> ReadImageInfo(std::span<const uint8_t> bytes);
Result<ImageFileInfo> ReadImageInfo(const std::filesystem::path& path);

/// A 16-bit one-channel PNG, as stored. Fails naming the file when it is missing, truncated, of
/// another kind, or not width x height (0 = any).
Result<Image<uint16_t>> ReadPng16(const std::filesystem::path& path, int width, int height);

/// A colour (or grey) 8-bit PNG or JPEG as RGB. Fails as ReadPng16.
Result<Image<Rgb8>> ReadColor(const std::filesystem::path& path, int width, int height);

/// A colour file as JPEG bytes: a JPEG byte for byte (once it is known to decode), a PNG encoded.
/// Fails as ReadPng16.
Result<std::vector<uint8_t>> ReadColorAsJpeg(const std::filesystem::path& path, int width,
                                             int height);

/// `color`, seen by `from`, as `to` would see it from the same place: nearest neighbour, black
/// outside. For colour that is aligned with depth but has another size.
Image<Rgb8> ResampleColor(const Image<Rgb8>& color, const PinholeCamera& from,
                          const PinholeCamera& to);

}  // namespace vismap
