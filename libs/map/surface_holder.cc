#include <zstd.h>

#include <atomic>
#include <bit>
#include <cstring>
#include <new>
#include <vector>

#include "base/require.h"
#include "map/block.h"

namespace vismap {
namespace {

// Packed voxels: a zstd frame. Its content: one bit
// per voxel that is not all zero; the size of the palette, one byte, and its labels; then for the
// voxels with a bit 14 planes of bytes, one after the other.
constexpr size_t kMaskBytes = kBlockVoxels / 8;
constexpr size_t kPlanes = 14;
constexpr size_t kMaxContent = kMaskBytes + 1 + 255 * sizeof(SegmentLabel) + kPlanes * kBlockVoxels;
constexpr int kLevel = 1;

using Content = std::array<uint8_t, kMaxContent>;

// The bytes of a voxel, in the order of the planes.
std::array<uint8_t, kPlanes> BytesOf(const SurfaceVoxels& voxels, size_t i) {
  const auto distance = static_cast<uint16_t>(voxels.distance[i]);
  const uint16_t weight = voxels.weight[i];
  const auto &labels = voxels.slot_label[i], &votes = voxels.slot_votes[i];
  const auto low = [](uint16_t value) { return static_cast<uint8_t>(value & 255); };
  const auto high = [](uint16_t value) { return static_cast<uint8_t>(value >> 8); };
  return {
      low(distance),     high(distance),    low(weight),       high(weight), voxels.observations[i],
      voxels.color[i].r, voxels.color[i].g, voxels.color[i].b, labels[0],    votes[0],
      labels[1],         votes[1],          labels[2],         votes[2]};
}

void SetBytes(const std::array<uint8_t, kPlanes>& bytes, size_t i, SurfaceVoxels* voxels) {
  const auto word = [&](size_t at) {
    return static_cast<uint16_t>(bytes[at] | bytes[at + 1] << 8);
  };
  voxels->distance[i] = static_cast<int16_t>(word(0));
  voxels->weight[i] = word(2);
  voxels->observations[i] = bytes[4];
  voxels->color[i] = {bytes[5], bytes[6], bytes[7]};
  voxels->slot_label[i] = {bytes[8], bytes[10], bytes[12]};
  voxels->slot_votes[i] = {bytes[9], bytes[11], bytes[13]};
}

size_t Write(const SurfaceVoxels& voxels, Content& content) {
  std::array<std::array<uint8_t, kBlockVoxels>, kPlanes> planes;
  VoxelBits mask{};
  size_t count = 0;
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    const std::array<uint8_t, kPlanes> bytes = BytesOf(voxels, i);
    if (bytes == std::array<uint8_t, kPlanes>{}) continue;
    mask[i / 64] |= uint64_t{1} << (i % 64);
    for (size_t plane = 0; plane < kPlanes; ++plane) planes[plane][count] = bytes[plane];
    ++count;
  }
  uint8_t* at = content.data();
  const auto put = [&](const void* data, size_t size) {
    std::memcpy(at, data, size);
    at += size;
  };
  put(mask.data(), kMaskBytes);
  const auto labels = static_cast<uint8_t>(voxels.palette.size());
  put(&labels, 1);
  if (labels > 0) put(voxels.palette.data(), labels * sizeof(SegmentLabel));
  for (const auto& plane : planes) put(plane.data(), count);
  return static_cast<size_t>(at - content.data());
}

void ReadContent(const Content& content, SurfaceVoxels* voxels) {
  VoxelBits mask;
  std::memcpy(mask.data(), content.data(), kMaskBytes);
  const size_t labels = content[kMaskBytes];
  const uint8_t* at = content.data() + kMaskBytes + 1;
  voxels->palette.resize(labels);
  if (labels > 0) std::memcpy(voxels->palette.data(), at, labels * sizeof(SegmentLabel));
  at += labels * sizeof(SegmentLabel);
  size_t count = 0;
  for (const uint64_t word : mask) count += static_cast<size_t>(std::popcount(word));
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    std::array<uint8_t, kPlanes> bytes{};
    if (mask[i / 64] >> (i % 64) & 1) {
      for (size_t plane = 0; plane < kPlanes; ++plane) bytes[plane] = at[plane * count];
      ++at;
    }
    SetBytes(bytes, i, voxels);
  }
}

// One context per thread, since it takes a megabyte.
struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};
ZSTD_CCtx* Compressor() {
  thread_local const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  return context.get();
}
ZSTD_DCtx* Decompressor() {
  thread_local const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  return context.get();
}

}  // namespace

struct SharedBytes::Head {
  std::atomic<uint32_t> users = 1;
  uint32_t size = 0;
};

SharedBytes::SharedBytes(std::span<const uint8_t> content) {
  auto* memory = static_cast<uint8_t*>(::operator new(sizeof(Head) + content.size()));
  head_ = new (memory) Head{.size = static_cast<uint32_t>(content.size())};
  std::memcpy(memory + sizeof(Head), content.data(), content.size());
}

SharedBytes::SharedBytes(const SharedBytes& other) noexcept : head_(other.head_) {
  if (head_ != nullptr) head_->users.fetch_add(1, std::memory_order_relaxed);
}

SharedBytes::~SharedBytes() {
  if (head_ == nullptr || head_->users.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
  head_->~Head();
  ::operator delete(head_);
}

std::span<const uint8_t> SharedBytes::content() const {
  return {reinterpret_cast<const uint8_t*>(head_ + 1), head_->size};
}

size_t SharedBytes::bytes() const { return sizeof(Head) + head_->size; }

size_t SurfaceHolder::packed_bytes() const { return packed_ ? packed_.bytes() : 0; }

void SurfaceHolder::Pack() {
  if (!voxels_) return;
  Content content;
  const size_t size = Write(*voxels_.get(), content);
  std::array<uint8_t, ZSTD_COMPRESSBOUND(kMaxContent)> packed;
  const size_t length =
      ZSTD_compressCCtx(Compressor(), packed.data(), packed.size(), content.data(), size, kLevel);
  Require(!ZSTD_isError(length), "zstd fits into its own bound");
  packed_ = SharedBytes({packed.data(), length});
  voxels_.reset();
}

void SurfaceHolder::CopyTo(SurfaceVoxels* voxels) const {
  Require(packed(), "CopyTo is for packed voxels");
  Content content;
  const std::span<const uint8_t> packed = packed_.content();
  const size_t size = ZSTD_decompressDCtx(Decompressor(), content.data(), content.size(),
                                          packed.data(), packed.size());
  Require(!ZSTD_isError(size), "zstd unpacks its own frame");
  ReadContent(content, voxels);
}

void SurfaceHolder::Unpack() {
  if (!packed()) return;
  auto voxels = Shared<SurfaceVoxels>::Make();
  CopyTo(&voxels.Own());
  *this = std::move(voxels);
}

}  // namespace vismap
