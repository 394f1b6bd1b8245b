#include "codecs/color_codec.h"

#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <type_traits>

#include "base/require.h"
#include "codecs/zstd_codec.h"

namespace vismap {
namespace {

struct FreeTurbo {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Turbo = std::unique_ptr<std::remove_pointer_t<tjhandle>, FreeTurbo>;

// ACCURATEDCT: the result has the same bits with and without SIMD. LIMITSCANS: a progressive file
// with thousands of scans is an error, since decoding it would take minutes.
constexpr int kDecodeFlags = TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS;

struct JpegInfo {
  JpegSize size;
  bool four_inks = false;  // CMYK or YCCK, as printers use them
};

std::string Text(JpegSize size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

Result<JpegInfo> ReadInfo(void* turbo, std::span<const uint8_t> bytes) {
  JpegSize size;
  int subsampling = 0, colorspace = 0;
  if (bytes.empty()) return Fail("JPEG: no bytes");
  if (tjDecompressHeader3(turbo, bytes.data(), bytes.size(), &size.width, &size.height,
                          &subsampling, &colorspace) != 0) {
    return Fail(std::string("JPEG: header is damaged: ") + tjGetErrorStr2(turbo));
  }
  // The library accepts a header that ends before the size of the image.
  if (size.width < 1 || size.height < 1) return Fail("JPEG: header is cut off");
  return JpegInfo{size, colorspace == TJCS_CMYK || colorspace == TJCS_YCCK};
}

// Decodes what there is. Warnings, such as stray bytes before a marker, which many cameras send,
// are no errors: the library goes on after them.
Result<void> Decompress(void* turbo, std::span<const uint8_t> bytes, JpegSize size, int format,
                        unsigned char* target) {
  const int status = tjDecompress2(turbo, bytes.data(), bytes.size(), target, size.width, 0,
                                   size.height, format, kDecodeFlags);
  if (status == 0 || tjGetErrorCode(turbo) == TJERR_WARNING) return {};
  return Fail(std::string("JPEG: data is damaged: ") + tjGetErrorStr2(turbo));
}

// Programs write inks inverted, 255 = none.
Image<Rgb8> FromInks(const std::vector<uint8_t>& inks, JpegSize size) {
  Image<Rgb8> image(size.width, size.height);
  for (size_t i = 0; i < image.size(); ++i) {
    const uint8_t* cmyk = &inks[4 * i];
    const auto part = [&](int ink) { return static_cast<uint8_t>((ink * cmyk[3] + 127) / 255); };
    image.data()[i] = {part(cmyk[0]), part(cmyk[1]), part(cmyk[2])};
  }
  return image;
}

}  // namespace

Result<JpegSize> ReadJpegSize(std::span<const uint8_t> bytes) {
  const Turbo turbo(tjInitDecompress());
  Require(turbo != nullptr, "turbojpeg gives a decoder");
  const Result<JpegInfo> info = ReadInfo(turbo.get(), bytes);
  if (!info) return tl::unexpected(info.error());
  return info->size;
}

bool HasJpegEnd(std::span<const uint8_t> bytes) {
  // In image data, 0xff is followed by 0, so these bytes are markers. The end of a preview stands
  // before the last start of image data.
  constexpr std::array<uint8_t, 2> kScan{0xff, 0xda}, kEnd{0xff, 0xd9};
  const auto scan = std::find_end(bytes.begin(), bytes.end(), kScan.begin(), kScan.end());
  return std::search(scan, bytes.end(), kEnd.begin(), kEnd.end()) != bytes.end();
}

Result<Image<Rgb8>> DecodeJpeg(std::span<const uint8_t> bytes, int width, int height,
                               size_t max_pixels) {
  const Turbo turbo(tjInitDecompress());
  Require(turbo != nullptr, "turbojpeg gives a decoder");
  const Result<JpegInfo> info = ReadInfo(turbo.get(), bytes);
  if (!info) return Fail(info.error().message);
  const JpegSize size = info->size;
  if ((width != 0 && size.width != width) || (height != 0 && size.height != height)) {
    return Fail("JPEG: size is " + Text(size) + "; expected " + Text({width, height}));
  }
  const Result<size_t> pixels = CheckedPixels(size.width, size.height, max_pixels);
  if (!pixels) return Fail("JPEG: " + pixels.error().message);
  if (!HasJpegEnd(bytes)) return Fail("JPEG: data is cut off");
  if (info->four_inks) {
    std::vector<uint8_t> inks(4 * *pixels);
    const auto decoded = Decompress(turbo.get(), bytes, size, TJPF_CMYK, inks.data());
    if (!decoded) return tl::unexpected(decoded.error());
    return FromInks(inks, size);
  }
  Image<Rgb8> image(size.width, size.height);
  static_assert(sizeof(Rgb8) == 3);
  auto* target = reinterpret_cast<unsigned char*>(image.data());
  const auto decoded = Decompress(turbo.get(), bytes, size, TJPF_RGB, target);
  if (!decoded) return tl::unexpected(decoded.error());
  return image;
}

std::vector<uint8_t> EncodeJpeg(const Image<Rgb8>& image, int quality) {
  Require(!image.empty() && image.width() <= 65500 && image.height() <= 65500,
          "JPEG sizes are 1..65500");
  Require(quality >= 1 && quality <= 100, "JPEG quality is 1..100");
  const Turbo turbo(tjInitCompress());
  Require(turbo != nullptr, "turbojpeg gives an encoder");
  std::vector<uint8_t> bytes(tjBufSize(image.width(), image.height(), TJSAMP_420));
  unsigned char* target = bytes.data();
  unsigned long size = bytes.size();
  const int status = tjCompress2(turbo.get(), reinterpret_cast<const unsigned char*>(image.data()),
                                 image.width(), 0, image.height(), TJPF_RGB, &target, &size,
                                 TJSAMP_420, quality, TJFLAG_ACCURATEDCT | TJFLAG_NOREALLOC);
  Require(status == 0, "turbojpeg encodes an image of legal size");
  bytes.resize(size);
  return bytes;
}

}  // namespace vismap
