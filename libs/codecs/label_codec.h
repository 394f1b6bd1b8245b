#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "codecs/color_codec.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Compresses a segment image without loss: run lengths along rows, then zstd. The code contains
/// `segment_count`, but not the size of the image. Every index must be kNone or in [0,
/// segment_count), and segment_count at most the number of pixels.
std::vector<uint8_t> EncodeSegmentImage(const SegmentImage& image);

/// Inverse of EncodeSegmentImage for an image of `width` x `height` pixels. Fails on any other
/// content, on indices outside [0, segment_count) and on more than `max_pixels`. Memory is at most
/// proportional to the number of pixels.
Result<SegmentImage> DecodeSegmentImage(std::span<const uint8_t> bytes, int width, int height,
                                        size_t max_pixels = kMaxDecodedPixels);

}  // namespace vismap
