#include "codecs/depth_codec.h"

#include "codecs/zstd_codec.h"

namespace vismap {
namespace {

// Neighbouring depths differ little, so that the high byte of a zigzag-folded difference is nearly
// always 0. All low bytes before all high bytes therefore give zstd long runs.
// tests/bench/depth_codec_bench.cc compares this with PNG and RVL.
uint16_t Fold(uint16_t difference) {
  return static_cast<uint16_t>((difference << 1) ^ (difference & 0x8000 ? 0xffff : 0));
}

uint16_t Unfold(uint16_t folded) {
  return static_cast<uint16_t>((folded >> 1) ^ (folded & 1 ? 0xffff : 0));
}

}  // namespace

std::vector<uint8_t> EncodeDepth(const Image<uint16_t>& depth) {
  const size_t count = depth.size();
  const uint16_t* pixels = depth.data();
  std::vector<uint8_t> planes(2 * count);
  for (size_t i = 0; i < count; ++i) {
    const uint16_t before = i == 0 ? uint16_t{0} : pixels[i - 1];
    const uint16_t folded = Fold(static_cast<uint16_t>(pixels[i] - before));
    planes[i] = static_cast<uint8_t>(folded & 0xff);
    planes[count + i] = static_cast<uint8_t>(folded >> 8);
  }
  return CompressBytes(planes);
}

Result<Image<uint16_t>> DecodeDepth(std::span<const uint8_t> bytes, int width, int height,
                                    size_t max_pixels) {
  const Result<size_t> count = CheckedPixels(width, height, max_pixels);
  if (!count) return Fail("depth code: " + count.error().message);
  const Result<std::vector<uint8_t>> planes = DecompressBytes(bytes, 2 * *count, 2 * *count);
  if (!planes) return Fail("depth code: " + planes.error().message);
  Image<uint16_t> depth(width, height);
  const uint8_t* low = planes->data();
  const uint8_t* high = low + *count;
  uint16_t value = 0;
  for (size_t i = 0; i < *count; ++i) {
    value = static_cast<uint16_t>(value + Unfold(static_cast<uint16_t>(low[i] | high[i] << 8)));
    depth.data()[i] = value;
  }
  return depth;
}

}  // namespace vismap
