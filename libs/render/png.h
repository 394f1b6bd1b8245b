#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"
#include "geometry/image.h"

namespace vismap {

/// The image as a PNG file. It must have at least one pixel.
std::vector<uint8_t> EncodePng(const Image<Rgb8>& image);

/// Writes EncodePng to a file (see WriteFileAtomically).
Result<void> WritePng(const std::filesystem::path& path, const Image<Rgb8>& image);

}  // namespace vismap
