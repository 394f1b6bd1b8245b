#include "codecs/png_codec.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "codecs/zstd_codec.h"

namespace vismap {
namespace {

constexpr std::array<uint8_t, 16> kPngStart{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n',
                                            0,    0,   0,   13,  'I',  'H',  'D',  'R'};

uint32_t BigEndian(const uint8_t* b) {
  return uint32_t{b[0]} << 24 | uint32_t{b[1]} << 16 | uint32_t{b[2]} << 8 | b[3];
}

Result<void> CheckPng(std::span<const uint8_t> bytes, const PngInfo& info, int width, int height,
                      size_t max_pixels) {
  const auto text = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
  if ((width != 0 && info.width != width) || (height != 0 && info.height != height)) {
    return Fail("PNG: size is " + text(info.width, info.height) + "; expected " +
                text(width, height));
  }
  if (const auto pixels = CheckedPixels(info.width, info.height, max_pixels); !pixels)
    return Fail("PNG: " + pixels.error().message);
  if (!HasPngEnd(bytes)) return Fail("PNG: data is truncated");
  return {};
}

// Fails if the PNG is damaged, or if size or type differ from the header.
Result<cv::Mat> Decode(std::span<const uint8_t> bytes, const PngInfo& info, int flags, int type) {
  cv::Mat image;
  try {
    // OpenCV does not write to its input.
    const cv::Mat code(1, static_cast<int>(bytes.size()), CV_8UC1,
                       const_cast<uint8_t*>(bytes.data()));
    image = cv::imdecode(code, flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& e) {
    return Fail("PNG: data is damaged: " + e.err);
  }
  if (image.empty() || image.cols != info.width || image.rows != info.height ||
      image.type() != type || !image.isContinuous()) {
    return Fail("PNG: data is damaged or truncated");
  }
  return image;
}

}  // namespace

Result<PngInfo> ReadPngInfo(std::span<const uint8_t> bytes) {
  constexpr size_t kHeaderBytes = 33;
  if (bytes.size() < kHeaderBytes || !std::equal(kPngStart.begin(), kPngStart.end(), bytes.begin()))
    return Fail("PNG: the bytes do not begin with the header of a PNG");
  constexpr int kGrey = 0;
  return PngInfo{static_cast<int>(BigEndian(&bytes[16])), static_cast<int>(BigEndian(&bytes[20])),
                 bytes[24], bytes[25] == kGrey};
}

bool HasPngEnd(std::span<const uint8_t> bytes) {
  // Decoders do not report missing rows.
  constexpr size_t kSignature = 8, kAroundData = 12;  // length, name and checksum of a chunk
  for (size_t at = kSignature; at + kAroundData <= bytes.size();) {
    if (std::memcmp(&bytes[at + 4], "IEND", 4) == 0) return true;
    at += kAroundData + BigEndian(&bytes[at]);
  }
  return false;
}

Result<Image<uint16_t>> DecodePng16(std::span<const uint8_t> bytes, int width, int height,
                                    size_t max_pixels) {
  const Result<PngInfo> info = ReadPngInfo(bytes);
  const std::string expected = "PNG: expected a 16-bit image with one channel, found ";
  if (!info) return Fail(expected + "bytes that do not begin with the header of a PNG");
  if (info->bits != 16 || !info->grey) {
    return Fail(expected + std::to_string(info->bits) + "-bit " + (info->grey ? "grey" : "colour"));
  }
  if (const auto checked = CheckPng(bytes, *info, width, height, max_pixels); !checked)
    return tl::unexpected(checked.error());
  const Result<cv::Mat> mat = Decode(bytes, *info, cv::IMREAD_UNCHANGED, CV_16UC1);
  if (!mat) return tl::unexpected(mat.error());
  Image<uint16_t> image(mat->cols, mat->rows);
  std::memcpy(image.data(), mat->data, image.size() * sizeof(uint16_t));
  return image;
}

Result<Image<Rgb8>> DecodeColorPng(std::span<const uint8_t> bytes, int width, int height,
                                   size_t max_pixels) {
  const Result<PngInfo> info = ReadPngInfo(bytes);
  if (!info) return tl::unexpected(info.error());
  if (const auto checked = CheckPng(bytes, *info, width, height, max_pixels); !checked)
    return tl::unexpected(checked.error());
  const Result<cv::Mat> mat = Decode(bytes, *info, cv::IMREAD_COLOR, CV_8UC3);
  if (!mat) return tl::unexpected(mat.error());
  Image<Rgb8> image(mat->cols, mat->rows);
  for (size_t i = 0; i < image.size(); ++i) {
    const uint8_t* bgr = mat->data + 3 * i;
    image.data()[i] = {bgr[2], bgr[1], bgr[0]};
  }
  return image;
}

}  // namespace vismap
