#include "codecs/label_codec.h"

#include <string>

#include "base/require.h"
#include "codecs/zstd_codec.h"

namespace vismap {
namespace {

// Content of the zstd frame: segment_count, then (run length, index + 1) pairs, all as LEB128.
// A number of 32 bits takes at most 5 bytes.
constexpr size_t kMaxNumberBytes = 5;

void Append(uint32_t number, std::vector<uint8_t>* bytes) {
  for (; number >= 0x80; number >>= 7) bytes->push_back(static_cast<uint8_t>(number | 0x80));
  bytes->push_back(static_cast<uint8_t>(number));
}

/// Reads LEB128 numbers. `ok` becomes false at the end of the bytes and for numbers above 32 bits.
struct NumberReader {
  std::span<const uint8_t> bytes;
  bool ok = true;

  uint32_t Next() {
    uint64_t number = 0;
    for (size_t i = 0; i < kMaxNumberBytes && i < bytes.size(); ++i) {
      number |= static_cast<uint64_t>(bytes[i] & 0x7f) << (7 * i);
      if (bytes[i] & 0x80) continue;
      bytes = bytes.subspan(i + 1);
      ok = ok && number <= UINT32_MAX;
      return static_cast<uint32_t>(number);
    }
    ok = false;
    return 0;
  }
};

uint32_t Shifted(SegmentIndex index) { return static_cast<uint32_t>(Raw(index) + 1); }

Result<SegmentImage> Parse(std::span<const uint8_t> content, int width, int height, size_t pixels) {
  NumberReader reader{content};
  const uint32_t segment_count = reader.Next();
  if (!reader.ok || segment_count > pixels) {
    return Fail("segment count is damaged or beyond the " + std::to_string(pixels) + " pixels");
  }
  SegmentImage image{Image<SegmentIndex>(width, height), static_cast<int>(segment_count)};
  SegmentIndex* next = image.index.data();
  SegmentIndex* const end = next + pixels;
  while (next != end) {
    const uint32_t run = reader.Next();
    const uint32_t shifted = reader.Next();
    if (!reader.ok || run == 0 || run > static_cast<size_t>(end - next)) {
      return Fail("runs do not fill exactly " + std::to_string(pixels) + " pixels");
    }
    if (shifted > segment_count) {
      return Fail("segment index " + std::to_string(int64_t{shifted} - 1) + " is beyond the " +
                  std::to_string(segment_count) + " segments");
    }
    std::fill_n(next, run, static_cast<SegmentIndex>(static_cast<int32_t>(shifted) - 1));
    next += run;
  }
  if (!reader.bytes.empty()) return Fail("bytes after the last run");
  return image;
}

}  // namespace

std::vector<uint8_t> EncodeSegmentImage(const SegmentImage& image) {
  const auto& index = image.index.pixels();
  Require(image.segment_count >= 0 && static_cast<size_t>(image.segment_count) <= index.size(),
          "a segment image has at most as many segments as pixels");
  std::vector<uint8_t> content;
  Append(static_cast<uint32_t>(image.segment_count), &content);
  for (size_t begin = 0, end = 0; begin < index.size(); begin = end) {
    while (end < index.size() && index[end] == index[begin]) ++end;
    Require(Raw(index[begin]) >= -1 && Raw(index[begin]) < image.segment_count,
            "a segment index is kNone or below segment_count");
    Append(static_cast<uint32_t>(end - begin), &content);
    Append(Shifted(index[begin]), &content);
  }
  return CompressBytes(content);
}

Result<SegmentImage> DecodeSegmentImage(std::span<const uint8_t> bytes, int width, int height,
                                        size_t max_pixels) {
  const Result<size_t> pixels = CheckedPixels(width, height, max_pixels);
  if (!pixels) return Fail("segment image code: " + pixels.error().message);
  const size_t longest = kMaxNumberBytes * (1 + 2 * *pixels);
  const Result<std::vector<uint8_t>> content = DecompressBytes(bytes, 1, longest);
  if (!content) return Fail("segment image code: " + content.error().message);
  Result<SegmentImage> image = Parse(*content, width, height, *pixels);
  if (!image) return Fail("segment image code: " + image.error().message);
  return image;
}

}  // namespace vismap
