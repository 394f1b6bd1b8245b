#include "codecs/raw_image.h"

#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "base/require.h"
#include "codecs/color_codec.h"
#include "codecs/png_codec.h"
#include "codecs/zstd_codec.h"

namespace vismap {
namespace {

static_assert(std::endian::native == std::endian::little, "raw pixels are copied as they are");

std::string PixelsText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

Result<size_t> CheckBytes(std::span<const uint8_t> bytes, int width, int height,
                          size_t bytes_per_pixel) {
  const Result<size_t> pixels = CheckedPixels(width, height, kMaxDecodedPixels);
  if (!pixels) return pixels;
  if (bytes.size() == *pixels * bytes_per_pixel) return pixels;
  return Fail("expected " + PixelsText(width, height) + " pixels of " +
              std::to_string(bytes_per_pixel) + " bytes, " +
              std::to_string(*pixels * bytes_per_pixel) + " bytes in all, found " +
              std::to_string(bytes.size()));
}

// Where red, green and blue stand in a raw pixel.
struct PixelLayout {
  size_t bytes = 3;
  size_t red = 0, green = 1, blue = 2;
};

std::optional<PixelLayout> LayoutOf(ColorEncoding encoding) {
  switch (encoding) {
    case ColorEncoding::kRgb:
      return PixelLayout{3, 0, 1, 2};
    case ColorEncoding::kBgr:
      return PixelLayout{3, 2, 1, 0};
    case ColorEncoding::kRgba:
      return PixelLayout{4, 0, 1, 2};
    case ColorEncoding::kBgra:
      return PixelLayout{4, 2, 1, 0};
    case ColorEncoding::kGrey:
      return PixelLayout{1, 0, 0, 0};
    default:
      return std::nullopt;
  }
}

// The size in the header; nullopt if that is damaged.
std::optional<JpegSize> StatedSize(ColorEncoding encoding, std::span<const uint8_t> bytes) {
  if (encoding == ColorEncoding::kPng) {
    const Result<PngInfo> info = ReadPngInfo(bytes);
    if (info) return JpegSize{info->width, info->height};
  } else if (const Result<JpegSize> size = ReadJpegSize(bytes)) {
    return *size;
  }
  return std::nullopt;
}

}  // namespace

Result<Image<uint16_t>> DecodeRaw16(std::span<const uint8_t> bytes, int width, int height) {
  const Result<size_t> pixels = CheckBytes(bytes, width, height, sizeof(uint16_t));
  if (!pixels) return Fail("raw depth: " + pixels.error().message);
  Image<uint16_t> depth = Image<uint16_t>::Unset(width, height);
  std::memcpy(depth.data(), bytes.data(), bytes.size());
  return depth;
}

Result<Image<uint16_t>> DecodeZlib16(std::span<const uint8_t> bytes, int width, int height) {
  const Result<size_t> pixels = CheckedPixels(width, height, kMaxDecodedPixels);
  if (!pixels) return Fail("zlib depth: " + pixels.error().message);
  Image<uint16_t> depth = Image<uint16_t>::Unset(width, height);
  const size_t size = *pixels * sizeof(uint16_t);
  z_stream stream{};
  stream.next_in = const_cast<Bytef*>(bytes.data());  // zlib does not write to its input
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(depth.data());
  stream.avail_out = static_cast<uInt>(size);
  Require(inflateInit(&stream) == Z_OK, "zlib gives a decoder");
  const int status = inflate(&stream, Z_FINISH);
  const std::string reason = stream.msg != nullptr ? stream.msg : "";
  const size_t found = stream.total_out, left = stream.avail_in;
  inflateEnd(&stream);
  const std::string expected = "zlib depth: expected " + std::to_string(size) + " bytes for " +
                               PixelsText(width, height) + " pixels, found ";
  if (status == Z_STREAM_END && found == size && left == 0) return depth;
  if (status == Z_STREAM_END && left > 0)
    return Fail("zlib depth: the stream has " + std::to_string(left) + " bytes after it");
  if (status == Z_STREAM_END) return Fail(expected + std::to_string(found));
  if (status == Z_BUF_ERROR && found == size) return Fail(expected + "more");
  return Fail("zlib depth: the stream is damaged or cut off" +
              (reason.empty() ? "" : ": " + reason));
}

Result<Image<float>> DecodeRawFloat(std::span<const uint8_t> bytes, int width, int height) {
  constexpr float kFarthest = 65534;  // [m]
  const Result<size_t> pixels = CheckBytes(bytes, width, height, sizeof(float));
  if (!pixels) return Fail("float depth: " + pixels.error().message);
  Image<float> depth = Image<float>::Unset(width, height);
  std::memcpy(depth.data(), bytes.data(), bytes.size());
  for (float& z : depth.pixels()) {
    if (!(z > 0 && z <= kFarthest)) z = std::numeric_limits<float>::quiet_NaN();
  }
  return depth;
}

std::vector<uint8_t> EncodeRawFloat(const Image<float>& depth_m) {
  const auto* bytes = reinterpret_cast<const uint8_t*>(depth_m.data());
  return {bytes, bytes + depth_m.size() * sizeof(float)};
}

Result<void> CheckColorSize(ColorEncoding encoding, std::span<const uint8_t> bytes, int width,
                            int height) {
  if (const auto layout = LayoutOf(encoding)) {
    const Result<size_t> pixels = CheckBytes(bytes, width, height, layout->bytes);
    if (!pixels) return Fail("raw colour: " + pixels.error().message);
    return {};
  }
  const std::optional<JpegSize> size = StatedSize(encoding, bytes);
  if (!size || *size == JpegSize{width, height}) return {};
  return Fail("the image is " + PixelsText(size->width, size->height) + "; expected " +
              PixelsText(width, height));
}

Result<Image<Rgb8>> DecodeColor(ColorEncoding encoding, std::span<const uint8_t> bytes, int width,
                                int height) {
  if (encoding == ColorEncoding::kJpeg) return DecodeJpeg(bytes, width, height);
  if (encoding == ColorEncoding::kPng) return DecodeColorPng(bytes, width, height);
  const auto layout = LayoutOf(encoding);
  if (!layout)
    return Fail("colour encoding " + std::to_string(static_cast<int>(encoding)) + " is unknown");
  const Result<size_t> pixels = CheckBytes(bytes, width, height, layout->bytes);
  if (!pixels) return Fail("raw colour: " + pixels.error().message);
  Image<Rgb8> image = Image<Rgb8>::Unset(width, height);
  const uint8_t* pixel = bytes.data();
  for (Rgb8& target : image.pixels()) {
    target = {pixel[layout->red], pixel[layout->green], pixel[layout->blue]};
    pixel += layout->bytes;
  }
  return image;
}

}  // namespace vismap
