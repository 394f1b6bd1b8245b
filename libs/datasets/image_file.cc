#include "datasets/image_file.h"

#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "base/file.h"
#include "codecs/color_codec.h"

namespace vismap {
namespace {

// Of a file: twice those of a frame, since colour may have more pixels than depth. A decoder needs
// up to nine bytes for each.
constexpr size_t kMaxFilePixels = 2 * kMaxImagePixels;
constexpr uint64_t kMaxImageFileBytes = uint64_t{1} << 30;
constexpr std::array<uint8_t, 16> kPngStart{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n',
                                            0,    0,   0,   13,  'I',  'H',  'D',  'R'};

int BigEndian(const uint8_t* b) {
  return int(uint32_t{b[0]} << 24 | b[1] << 16 | b[2] << 8 | b[3]);
}

ImageFileInfo ParsePngHeader(std::span<const uint8_t> bytes) {
  constexpr int kGrey = 0;
  return {.kind = ImageFileInfo::Kind::kPng,
          .width = BigEndian(&bytes[16]),
          .height = BigEndian(&bytes[20]),
          .bits = bytes[24],
          .grey = bytes[25] == kGrey};
}

Result<void> CheckSize(const ImageFileInfo& info, int width, int height) {
  if ((width == 0 || info.width == width) && (height == 0 || info.height == height)) return {};
  return Fail("the image is " + SizeText(info.width, info.height) + "; expected " +
              SizeText(width, height));
}

/// Decodes a PNG with OpenCV. Fails if it is damaged, or if size or type differ from the header.
Result<cv::Mat> DecodePng(const std::vector<uint8_t>& bytes, const ImageFileInfo& size, int flags,
                          int type) {
  cv::Mat image;
  try {
    image = cv::imdecode(bytes, flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& e) {
    return Fail("the PNG is damaged: " + e.err);
  }
  if (image.empty() || image.cols != size.width || image.rows != size.height ||
      image.type() != type || !image.isContinuous()) {
    return Fail("the PNG is damaged or truncated");
  }
  return image;
}

/// Whether a PNG file has its end chunk, perhaps followed by other bytes. Decoders do not report
/// missing rows, so this check finds truncated files.
bool HasPngEnd(std::span<const uint8_t> bytes) {
  constexpr size_t kSignature = 8, kAroundData = 12;  // length, name and checksum of a chunk
  for (size_t at = kSignature; at + kAroundData <= bytes.size();) {
    if (std::memcmp(&bytes[at + 4], "IEND", 4) == 0) return true;
    at += kAroundData + static_cast<uint32_t>(BigEndian(&bytes[at]));
  }
  return false;
}

Result<Image<uint16_t>> DecodePng16(const std::vector<uint8_t>& bytes, int width, int height) {
  const Result<ImageFileInfo> info = ReadImageInfo(bytes);
  if (!info) return Fail(info.error().message);
  if (info->kind != ImageFileInfo::Kind::kPng || info->bits != 16 || !info->grey) {
    return Fail(std::string("expected a 16-bit one-channel PNG, found ") +
                std::to_string(info->bits) + "-bit " + (info->grey ? "grey" : "colour"));
  }
  if (const auto checked = CheckSize(*info, width, height); !checked) {
    return Fail(checked.error().message);
  }
  if (!HasPngEnd(bytes)) return Fail("the PNG is truncated");
  const Result<cv::Mat> mat = DecodePng(bytes, *info, cv::IMREAD_UNCHANGED, CV_16UC1);
  if (!mat) return Fail(mat.error().message);
  Image<uint16_t> image(mat->cols, mat->rows);
  std::memcpy(image.data(), mat->data, image.size() * sizeof(uint16_t));
  return image;
}

Result<Image<Rgb8>> DecodeColorPng(const std::vector<uint8_t>& bytes, const ImageFileInfo& info) {
  if (!HasPngEnd(bytes)) return Fail("the PNG is truncated");
  const Result<cv::Mat> mat = DecodePng(bytes, info, cv::IMREAD_COLOR, CV_8UC3);
  if (!mat) return Fail(mat.error().message);
  Image<Rgb8> image(mat->cols, mat->rows);
  for (size_t i = 0; i < image.size(); ++i) {
    const uint8_t* bgr = mat->data + 3 * i;
    image.data()[i] = {bgr[2], bgr[1], bgr[0]};
  }
  return image;
}

Result<Image<Rgb8>> DecodeColor(const std::vector<uint8_t>& bytes, int width, int height) {
  const Result<ImageFileInfo> info = ReadImageInfo(bytes);
  if (!info) return Fail(info.error().message);
  if (const auto checked = CheckSize(*info, width, height); !checked) {
    return Fail(checked.error().message);
  }
  return info->kind == ImageFileInfo::Kind::kJpeg ? DecodeJpeg(bytes, 0, 0, kMaxFilePixels)
                                                  : DecodeColorPng(bytes, *info);
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
  if (bytes.size() >= 33 && std::memcmp(bytes.data(), kPngStart.data(), kPngStart.size()) == 0) {
    info = ParsePngHeader(bytes);
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
  const bool png = bytes->size() >= kPngStart.size() &&
                   std::memcmp(bytes->data(), kPngStart.data(), kPngStart.size()) == 0;
  const bool jpeg = bytes->size() >= 2 && (*bytes)[0] == 0xff && (*bytes)[1] == 0xd8;
  return bytes->size() < kPngStart.size() || (png && !HasPngEnd(*bytes)) ||
         (jpeg && !HasJpegEnd(*bytes));
}

Result<Image<uint16_t>> ReadPng16(const std::filesystem::path& path, int width, int height) {
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, kMaxImageFileBytes);
  if (!bytes) return Fail(bytes.error().message);
  return WithPath(path, DecodePng16(*bytes, width, height));
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
