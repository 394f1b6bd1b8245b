#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"
#include "geometry/image.h"

namespace vismap {

/// PNG of an image with at least one pixel.
std::vector<uint8_t> EncodePng(const Image<Rgb8>& image);

/// EncodePng to a file, in one piece or not at all (see WriteFileAtomically).
Result<void> WritePng(const std::filesystem::path& path, const Image<Rgb8>& image);

}  // namespace vismap
