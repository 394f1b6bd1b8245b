#include "codecs/color_codec.h"

#include <turbojpeg.h>

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

// ACCURATEDCT: the result has the same bits with and without SIMD. STOPONWARNING: missing or
// damaged data is an error instead of grey pixels. LIMITSCANS: a progressive file with thousands of
// scans is an error, since decoding it would take minutes.
constexpr int kDecodeFlags = TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;

std::string Text(JpegSize size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

Result<JpegSize> ReadSize(void* turbo, std::span<const uint8_t> bytes) {
  JpegSize size;
  int subsampling = 0, colorspace = 0;
  if (bytes.empty()) return Fail("JPEG: no bytes");
  if (tjDecompressHeader3(turbo, bytes.data(), bytes.size(), &size.width, &size.height,
                          &subsampling, &colorspace) != 0) {
    return Fail(std::string("JPEG: header is damaged: ") + tjGetErrorStr2(turbo));
  }
  // The library accepts a header that ends before the size of the image.
  if (size.width < 1 || size.height < 1) return Fail("JPEG: header is cut off");
  return size;
}

}  // namespace

Result<JpegSize> ReadJpegSize(std::span<const uint8_t> bytes) {
  const Turbo turbo(tjInitDecompress());
  Require(turbo != nullptr, "turbojpeg gives a decoder");
  return ReadSize(turbo.get(), bytes);
}

Result<Image<Rgb8>> DecodeJpeg(std::span<const uint8_t> bytes, int width, int height,
                               size_t max_pixels) {
  const Turbo turbo(tjInitDecompress());
  Require(turbo != nullptr, "turbojpeg gives a decoder");
  const Result<JpegSize> size = ReadSize(turbo.get(), bytes);
  if (!size) return Fail(size.error().message);
  if ((width != 0 && size->width != width) || (height != 0 && size->height != height)) {
    return Fail("JPEG: size is " + Text(*size) + "; expected " + Text({width, height}));
  }
  const Result<size_t> pixels = CheckedPixels(size->width, size->height, max_pixels);
  if (!pixels) return Fail("JPEG: " + pixels.error().message);
  Image<Rgb8> image(size->width, size->height);
  static_assert(sizeof(Rgb8) == 3);
  auto* target = reinterpret_cast<unsigned char*>(image.data());
  if (tjDecompress2(turbo.get(), bytes.data(), bytes.size(), target, size->width, 0, size->height,
                    TJPF_RGB, kDecodeFlags) != 0) {
    return Fail(std::string("JPEG: data is damaged: ") + tjGetErrorStr2(turbo.get()));
  }
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
