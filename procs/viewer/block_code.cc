#include "viewer/block_code.h"

#include <zstd.h>

#include <memory>
#include <string>

#include "base/require.h"

namespace vismap {
namespace {

constexpr unsigned long long kMostBlock = 1 << 28;  // [bytes]

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

}  // namespace

std::vector<uint8_t> CompressBlock(std::span<const uint8_t> bytes) {
  thread_local const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  thread_local std::vector<uint8_t> code;
  code.resize(ZSTD_compressBound(bytes.size()));
  const size_t size = ZSTD_compressCCtx(context.get(), code.data(), code.size(), bytes.data(),
                                        bytes.size(), /*compressionLevel=*/1);
  Require(ZSTD_isError(size) == 0, "zstd compresses into a buffer of its own bound");
  return {code.begin(), code.begin() + static_cast<std::ptrdiff_t>(size)};
}

Result<std::vector<uint8_t>> DecompressBlock(std::span<const uint8_t> bytes) {
  thread_local const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  const unsigned long long stated = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (stated > kMostBlock) return Fail("a block of the recording is damaged");
  std::vector<uint8_t> content(static_cast<size_t>(stated));
  const size_t size = ZSTD_decompressDCtx(context.get(), content.data(), content.size(),
                                          bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0 || size != content.size())
    return Fail(std::string("a block of the recording is damaged: ") + ZSTD_getErrorName(size));
  return content;
}

}  // namespace vismap
