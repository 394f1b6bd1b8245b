#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "geometry/camera.h"
#include "geometry/image.h"

namespace vismap {

/// The size of an image for people: "640x480".
std::string SizeText(int width, int height);

/// The properties of an image that are in the header of its file.
struct ImageFileInfo {
  enum class Kind { kPng, kJpeg } kind = Kind::kPng;
  int width = 0;
  int height = 0;
  int bits = 8;       ///< per channel
  bool grey = false;  ///< one channel, without a palette
};

/// Reads the header of a PNG or JPEG file. Fails on other files, on sides of more than 16384 pixels
/// and on more than 2^25 pixels in all.
Result<ImageFileInfo> ReadImageInfo(std::span<const uint8_t> bytes);
Result<ImageFileInfo> ReadImageInfo(const std::filesystem::path& path);

/// Whether the file is the beginning of a PNG or JPEG, or empty, as when a recorder was stopped
/// while it wrote.
bool IsCutOff(const std::filesystem::path& path);

/// Reads a 16-bit PNG with one channel. Fails, naming the file, if it is missing, truncated or of
/// another kind, or if its size is not width x height (0 = any).
Result<Image<uint16_t>> ReadPng16(const std::filesystem::path& path, int width, int height);

/// Reads a PNG or JPEG, colour or grey, as RGB with 8 bits. Fails like ReadPng16.
Result<Image<Rgb8>> ReadColor(const std::filesystem::path& path, int width, int height);

/// Reads a colour file as JPEG bytes. A JPEG file is returned unchanged after a test that it can be
/// decoded; a PNG file is encoded as JPEG. Fails like ReadPng16.
Result<std::vector<uint8_t>> ReadColorAsJpeg(const std::filesystem::path& path, int width,
                                             int height);

/// Resamples a colour image of the camera `from` to the camera `to` at the same pose: nearest
/// neighbour, black outside. It is for colour that is aligned with depth but has another size.
Image<Rgb8> ResampleColor(const Image<Rgb8>& color, const PinholeCamera& from,
                          const PinholeCamera& to);

}  // namespace vismap
