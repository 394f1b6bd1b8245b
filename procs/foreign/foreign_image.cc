#include "foreign/foreign_image.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <type_traits>

#include "codecs/color_codec.h"
#include "codecs/png_codec.h"
#include "codecs/raw_image.h"
#include "geometry/camera.h"

namespace vismap {
namespace {

void SwapBytes(int value_bytes, std::vector<uint8_t>* bytes) {
  const auto step = static_cast<size_t>(value_bytes);
  for (size_t i = 0; i + step <= bytes->size(); i += step) {
    std::reverse(bytes->begin() + static_cast<std::ptrdiff_t>(i),
                 bytes->begin() + static_cast<std::ptrdiff_t>(i + step));
  }
}

std::string ImageSizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

/// Replaces pixels that have one of the values; `bytes` are little-endian, as this computer is.
template <typename T>
void ReplaceValues(const std::vector<double>& values, T none, std::vector<uint8_t>* bytes) {
  std::vector<T> wanted;
  for (const double value : values) {
    const bool fits = value == std::floor(value) && value <= std::numeric_limits<T>::max();
    if (std::is_floating_point_v<T> || fits) wanted.push_back(static_cast<T>(value));
  }
  for (size_t at = 0; at + sizeof(T) <= bytes->size(); at += sizeof(T)) {
    T pixel;
    std::memcpy(&pixel, bytes->data() + at, sizeof(T));
    if (std::find(wanted.begin(), wanted.end(), pixel) != wanted.end())
      std::memcpy(bytes->data() + at, &none, sizeof(T));
  }
}

/// Unpacks a depth image of integers.
Result<void> MakeRaw(ForeignImage* image) {
  if (image->format == PixelFormat::kDepth16) return {};
  Result<Image<uint16_t>> depth = image->format == PixelFormat::kDepthPng
                                      ? DecodePng16(image->bytes, image->width, image->height)
                                      : DecodeZlib16(image->bytes, image->width, image->height);
  if (!depth) return tl::unexpected(depth.error());
  image->format = PixelFormat::kDepth16;
  image->bytes.resize(depth->size() * sizeof(uint16_t));
  std::memcpy(image->bytes.data(), depth->data(), image->bytes.size());
  return {};
}

}  // namespace

Result<std::vector<uint8_t>> TightRows(RawPixels pixels) {
  if (pixels.width <= 0 || pixels.height <= 0 || pixels.width > kMaxImageSide ||
      pixels.height > kMaxImageSide)
    return Fail("an image of " + ImageSizeText(pixels.width, pixels.height) + " pixels");
  const auto width = static_cast<size_t>(pixels.width), height = static_cast<size_t>(pixels.height);
  const size_t row = width * static_cast<size_t>(pixels.pixel_bytes);
  const size_t step = pixels.row_bytes == 0 ? row : static_cast<size_t>(pixels.row_bytes);
  if (pixels.row_bytes < 0 || step < row || step > pixels.bytes.size() ||
      pixels.bytes.size() < step * (height - 1) + row) {
    return Fail("an image of " + ImageSizeText(pixels.width, pixels.height) +
                " pixels with rows of " + std::to_string(pixels.row_bytes) + " bytes has " +
                std::to_string(pixels.bytes.size()) + " bytes");
  }
  if (step != row) {
    for (size_t v = 1; v < height; ++v)
      std::memmove(pixels.bytes.data() + v * row, pixels.bytes.data() + v * step, row);
  }
  pixels.bytes.resize(row * height);
  if (pixels.big_endian && pixels.value_bytes > 1) SwapBytes(pixels.value_bytes, &pixels.bytes);
  return std::move(pixels.bytes);
}

Result<std::vector<uint8_t>> InflateZlib(const std::vector<uint8_t>& packed, size_t bytes) {
  constexpr size_t kMostExpansion = 1032;  // of a deflate stream
  if (bytes > 8 * kMaxImagePixels || bytes / kMostExpansion > packed.size())
    return Fail("a zlib stream of an image that is too large");
  std::vector<uint8_t> plain(bytes);
  uLongf got = plain.size();
  const int status = uncompress(plain.data(), &got, packed.data(), packed.size());
  if (status != Z_OK || got != plain.size()) {
    return Fail("a zlib stream is damaged or does not hold the " + std::to_string(bytes) +
                " bytes of its image");
  }
  return plain;
}

std::vector<uint8_t> FloatsOfDoubles(const std::vector<uint8_t>& doubles) {
  std::vector<uint8_t> floats(doubles.size() / 2);
  for (size_t i = 0; i < doubles.size() / 8; ++i) {
    double value = 0;
    std::memcpy(&value, doubles.data() + 8 * i, 8);
    const auto narrow = static_cast<float>(value);
    std::memcpy(floats.data() + 4 * i, &narrow, 4);
  }
  return floats;
}

std::vector<uint8_t> UpperBytes(const std::vector<uint8_t>& values) {
  std::vector<uint8_t> upper(values.size() / 2);
  for (size_t i = 0; i < upper.size(); ++i) upper[i] = values[2 * i + 1];
  return upper;
}

void ClearNegative(std::vector<uint8_t>* values) {
  for (size_t i = 0; i + 1 < values->size(); i += 2) {
    if ((*values)[i + 1] & 0x80) (*values)[i] = (*values)[i + 1] = 0;
  }
}

Result<ForeignImage> ClearNoneValues(ForeignImage image, const std::vector<double>& none_values) {
  std::vector<double> values;
  std::copy_if(none_values.begin(), none_values.end(), std::back_inserter(values),
               [](double value) { return value != 0 && value != 65535; });
  if (values.empty()) return image;
  if (image.format == PixelFormat::kDepthFloat) {
    ReplaceValues<float>(values, std::numeric_limits<float>::quiet_NaN(), &image.bytes);
    return image;
  }
  if (const Result<void> raw = MakeRaw(&image); !raw) return tl::unexpected(raw.error());
  ReplaceValues<uint16_t>(values, 0, &image.bytes);
  return image;
}

Result<void> CheckPixels(const ForeignImage& image) {
  const auto checked = [](const auto& decoded) -> Result<void> {
    if (!decoded) return tl::unexpected(decoded.error());
    return {};
  };
  switch (image.format) {
    case PixelFormat::kJpeg:
      return checked(DecodeJpeg(image.bytes, image.width, image.height));
    case PixelFormat::kPng:
      return checked(DecodeColorPng(image.bytes, image.width, image.height));
    case PixelFormat::kDepth16Zlib:
      return checked(DecodeZlib16(image.bytes, image.width, image.height));
    case PixelFormat::kDepthPng:
      return checked(DecodePng16(image.bytes, image.width, image.height));
    default:
      return {};
  }
}

Result<ForeignImage> SwapRedBlue(ForeignImage image) {
  switch (image.format) {
    case PixelFormat::kRgb:
      image.format = PixelFormat::kBgr;
      return image;
    case PixelFormat::kBgr:
      image.format = PixelFormat::kRgb;
      return image;
    case PixelFormat::kRgba:
      image.format = PixelFormat::kBgra;
      return image;
    case PixelFormat::kBgra:
      image.format = PixelFormat::kRgba;
      return image;
    case PixelFormat::kJpeg:
    case PixelFormat::kPng: {
      const Result<Image<Rgb8>> decoded =
          image.format == PixelFormat::kJpeg
              ? DecodeJpeg(image.bytes, image.width, image.height)
              : DecodeColorPng(image.bytes, image.width, image.height);
      if (!decoded) return tl::unexpected(decoded.error());
      image.bytes.resize(decoded->size() * sizeof(Rgb8));
      std::memcpy(image.bytes.data(), decoded->data(), image.bytes.size());
      image.format = PixelFormat::kBgr;
      return image;
    }
    default:
      return image;
  }
}

}  // namespace vismap
