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

/// COCO run lengths of a mask over its whole image: column by column (v fastest), alternating
/// outside, inside, outside, ...; the first run (outside) may be 0. They add up to width * height.
using MaskRuns = std::vector<uint32_t>;

/// The mask of all non-zero pixels of a whole image, cropped to their bounding box; an empty mask
/// has a 0x0 box at (0, 0).
Mask MaskFromImage(const Image<uint8_t>& image);

/// COCO run lengths of a mask.
MaskRuns EncodeMask(const Mask& mask);

/// The mask with these run lengths in an image of `width` x `height` pixels, cropped to its
/// bounding box. Fails unless the runs add up to exactly width * height and that is at most
/// `max_pixels`.
Result<Mask> DecodeMask(std::span<const uint32_t> runs, int width, int height,
                        size_t max_pixels = kMaxDecodedPixels);

/// COCO's "compressed" counts: each run, from the fourth on less the run two before, in 5-bit
/// groups from the lowest with a continuation bit, as characters from '0' on.
std::string RunsToString(std::span<const uint32_t> runs);

/// Inverse of RunsToString. Fails on foreign characters, a cut-off number, or a run that is
/// negative or beyond 32 bits.
Result<MaskRuns> RunsFromString(std::string_view text);

}  // namespace vismap
