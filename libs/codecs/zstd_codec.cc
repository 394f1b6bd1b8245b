#include "codecs/zstd_codec.h"

#include <zstd.h>

#include <memory>
#include <string>

#include "base/require.h"

namespace vismap {
namespace {

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};

std::string SizeText(unsigned long long size) {
  return size == ZSTD_CONTENTSIZE_UNKNOWN ? "unstated size" : std::to_string(size) + " bytes";
}

}  // namespace

std::vector<uint8_t> CompressBytes(std::span<const uint8_t> bytes) {
  const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  Require(context != nullptr, "zstd gives a compression context");
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, 1);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::vector<uint8_t> code(ZSTD_compressBound(bytes.size()));
  const size_t size =
      ZSTD_compress2(context.get(), code.data(), code.size(), bytes.data(), bytes.size());
  Require(ZSTD_isError(size) == 0, "zstd compresses into a buffer of its own bound");
  code.resize(size);
  return code;
}

Result<std::vector<uint8_t>> DecompressBytes(std::span<const uint8_t> bytes, size_t min_size,
                                             size_t max_size) {
  const unsigned long long stated = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR) return Fail("not a zstd frame");
  if (stated == ZSTD_CONTENTSIZE_UNKNOWN || stated < min_size || stated > max_size) {
    return Fail("zstd frame holds " + SizeText(stated) + "; expected " + std::to_string(min_size) +
                ".." + std::to_string(max_size));
  }
  const size_t frame_size = ZSTD_findFrameCompressedSize(bytes.data(), bytes.size());
  if (ZSTD_isError(frame_size) != 0) {
    return Fail(std::string("zstd frame is damaged: ") + ZSTD_getErrorName(frame_size));
  }
  if (frame_size != bytes.size()) {
    return Fail("zstd frame has " + std::to_string(bytes.size() - frame_size) + " bytes after it");
  }
  std::vector<uint8_t> content(static_cast<size_t>(stated));
  const size_t size = ZSTD_decompress(content.data(), content.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0 || size != content.size()) {
    return Fail(std::string("zstd frame is damaged: ") + ZSTD_getErrorName(size));
  }
  return content;
}

Result<size_t> CheckedPixels(int width, int height, size_t max_pixels) {
  if (width < 1 || height < 1 ||
      static_cast<size_t>(width) * static_cast<size_t>(height) > max_pixels) {
    return Fail("image size is " + std::to_string(width) + "x" + std::to_string(height) +
                "; expected 1x1 or more and at most " + std::to_string(max_pixels) + " pixels");
  }
  return static_cast<size_t>(width) * static_cast<size_t>(height);
}

}  // namespace vismap
