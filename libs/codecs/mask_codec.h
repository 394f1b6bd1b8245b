#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "codecs/color_codec.h"
#include "geometry/image.h"
#include "segmentation/detections.h"

namespace vismap {

/// COCO run lengths of a mask over its whole image, column by column: pixels outside, inside,
/// outside,
/// ...; the first run may be 0. Their sum is width * height.
using MaskRuns = std::vector<uint32_t>;

/// The mask of all pixels of an image that are not 0, cropped to their bounding box. An empty mask
/// has a box of 0x0 pixels at (0, 0).
Mask MaskFromImage(const Image<uint8_t>& image);

/// COCO run lengths of a mask.
MaskRuns EncodeMask(const Mask& mask);

/// The mask with these run lengths in an image of `width` x `height` pixels, cropped to its
/// bounding box. Fails unless the runs add up to exactly width * height and that is at most
/// `max_pixels`.
Result<Mask> DecodeMask(std::span<const uint32_t> runs, int width, int height,
                        size_t max_pixels = kMaxDecodedPixels);

/// COCO's "compressed" counts. From the fourth run on, the run two before is subtracted. Numbers
/// are written in groups of 5 bits, the lowest first, with a continuation bit, as characters from
/// '0' on.
std::string RunsToString(std::span<const uint32_t> runs);

/// Inverse of RunsToString. Fails on other characters, a truncated number, and a run that is
/// negative or above 32 bits.
Result<MaskRuns> RunsFromString(std::string_view text);

}  // namespace vismap
