#include "datasets/image_file.h"

#include <cmath>

#include "base/file.h"
#include "codecs/color_codec.h"
#include "codecs/png_codec.h"

namespace vismap {
namespace {

// Of a file: twice those of a frame, since colour may have more pixels than depth. A decoder needs
// up to nine bytes for each.
constexpr size_t kMaxFilePixels = 2 * kMaxImagePixels;
constexpr size_t kShortest = 33;  // the header of a PNG [bytes]
constexpr uint64_t kMaxImageFileBytes = uint64_t{1} << 30;

Result<void> CheckSize(const ImageFileInfo& info, int width, int height) {
  if ((width == 0 || info.width == width) && (height == 0 || info.height == height)) return {};
  return Fail("the image is " + SizeText(info.width, info.height) + "; expected " +
              SizeText(width, height));
}

Result<Image<Rgb8>> DecodeColor(const std::vector<uint8_t>& bytes, int width, int height) {
  const Result<ImageFileInfo> info = ReadImageInfo(bytes);
  if (!info) return Fail(info.error().message);
  if (const auto checked = CheckSize(*info, width, height); !checked) {
    return Fail(checked.error().message);
  }
  return info->kind == ImageFileInfo::Kind::kJpeg ? DecodeJpeg(bytes, 0, 0, kMaxFilePixels)
                                                  : DecodeColorPng(bytes, 0, 0, kMaxFilePixels);
}

/// The result, with the path at the front of its error.
template <typename T>
Result<T> WithPath(const std::filesystem::path& path, Result<T> result) {
  if (!result) return Fail(path.string() + ": " + result.error().message);
  return result;
}

}  // namespace

std::string SizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

Result<ImageFileInfo> ReadImageInfo(std::span<const uint8_t> bytes) {
  ImageFileInfo info;
  if (const Result<PngInfo> png = ReadPngInfo(bytes)) {
    info = {.kind = ImageFileInfo::Kind::kPng,
            .width = png->width,
            .height = png->height,
            .bits = png->bits,
            .grey = png->grey};
  } else if (bytes.size() > 2 && bytes[0] == 0xff && bytes[1] == 0xd8) {
    const Result<JpegSize> size = ReadJpegSize(bytes);
    if (!size) return Fail(size.error().message);
    info = {.kind = ImageFileInfo::Kind::kJpeg, .width = size->width, .height = size->height};
  } else {
    return Fail("expected a PNG or JPEG image, found neither a PNG nor a JPEG header");
  }
  const auto fits = [](int side) { return side >= 1 && side <= kMaxImageSide; };
  if (!fits(info.width) || !fits(info.height) ||
      static_cast<size_t>(info.width) * static_cast<size_t>(info.height) > kMaxFilePixels) {
    return Fail("the image is " + SizeText(info.width, info.height) + "; expected 1.." +
                std::to_string(kMaxImageSide) + " pixels along each side and at most " +
                std::to_string(kMaxFilePixels) + " in all");
  }
  return info;
}

Result<ImageFileInfo> ReadImageInfo(const std::filesystem::path& path) {
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, kMaxImageFileBytes);
  if (!bytes) return Fail(bytes.error().message);
  return WithPath(path, ReadImageInfo(std::span<const uint8_t>(*bytes)));
}

bool IsCutOff(const std::filesystem::path& path) {
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, kMaxImageFileBytes);
  if (!bytes) return false;
  const bool png = ReadPngInfo(*bytes).has_value();
  const bool jpeg = bytes->size() >= 2 && (*bytes)[0] == 0xff && (*bytes)[1] == 0xd8;
  return bytes->size() < kShortest || (png && !HasPngEnd(*bytes)) || (jpeg && !HasJpegEnd(*bytes));
}

Result<Image<uint16_t>> ReadPng16(const std::filesystem::path& path, int width, int height) {
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, kMaxImageFileBytes);
  if (!bytes) return Fail(bytes.error().message);
  return WithPath(path, DecodePng16(*bytes, width, height, kMaxFilePixels));
}

Result<Image<Rgb8>> ReadColor(const std::filesystem::path& path, int width, int height) {
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, kMaxImageFileBytes);
  if (!bytes) return Fail(bytes.error().message);
  return WithPath(path, DecodeColor(*bytes, width, height));
}

Result<std::vector<uint8_t>> ReadColorAsJpeg(const std::filesystem::path& path, int width,
                                             int height) {
  Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, kMaxImageFileBytes);
  if (!bytes) return Fail(bytes.error().message);
  const Result<Image<Rgb8>> image = WithPath(path, DecodeColor(*bytes, width, height));
  if (!image) return Fail(image.error().message);
  if (ReadImageInfo(std::span<const uint8_t>(*bytes))->kind == ImageFileInfo::Kind::kJpeg) {
    return bytes;
  }
  return EncodeJpeg(*image);
}

Image<Rgb8> ResampleColor(const Image<Rgb8>& color, const PinholeCamera& from,
                          const PinholeCamera& to) {
  Image<Rgb8> image(to.width, to.height);
  for (int v = 0; v < to.height; ++v) {
    const int row = static_cast<int>(std::lround((v - to.cy) / to.fy * from.fy + from.cy));
    for (int u = 0; u < to.width; ++u) {
      const int column = static_cast<int>(std::lround((u - to.cx) / to.fx * from.fx + from.cx));
      if (color.Contains(row, column)) image(v, u) = color(row, column);
    }
  }
  return image;
}

}  // namespace vismap
