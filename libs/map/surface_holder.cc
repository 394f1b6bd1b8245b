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

// The voxels that are not all zero, ascending.
struct UsedVoxels {
  std::array<uint16_t, kBlockVoxels> voxels;
  size_t count = 0;
};

UsedVoxels UsedIn(const uint8_t* bits) {
  VoxelBits mask;
  std::memcpy(mask.data(), bits, kMaskBytes);
  UsedVoxels used;
  for (size_t word = 0; word < mask.size(); ++word) {
    for (uint64_t left = mask[word]; left != 0; left &= left - 1)
      used.voxels[used.count++] =
          static_cast<uint16_t>(64 * word + static_cast<size_t>(std::countr_zero(left)));
  }
  return used;
}

// Field by field, since a loop over one field alone takes a fraction of the time of one over all.
void ReadPlanes(const uint8_t* planes, const UsedVoxels& used, SurfaceVoxels* voxels) {
  const size_t count = used.count;
  const auto for_each = [&](const auto& set) {
    for (size_t i = 0; i < count; ++i) set(size_t{used.voxels[i]}, i);
  };
  const auto word = [&](size_t plane, size_t i) {
    return static_cast<uint16_t>(planes[plane * count + i] | planes[(plane + 1) * count + i] << 8);
  };
  const auto byte = [&](size_t plane, size_t i) { return planes[plane * count + i]; };
  for_each([&](size_t at, size_t i) { voxels->distance[at] = static_cast<int16_t>(word(0, i)); });
  for_each([&](size_t at, size_t i) { voxels->weight[at] = word(2, i); });
  for_each([&](size_t at, size_t i) { voxels->observations[at] = byte(4, i); });
  for_each([&](size_t at, size_t i) { voxels->color[at] = {byte(5, i), byte(6, i), byte(7, i)}; });
  for_each([&](size_t at, size_t i) {
    voxels->slot_label[at] = {byte(8, i), byte(10, i), byte(12, i)};
  });
  for_each([&](size_t at, size_t i) {
    voxels->slot_votes[at] = {byte(9, i), byte(11, i), byte(13, i)};
  });
}

void ReadContent(const Content& content, SurfaceVoxels* voxels) {
  const UsedVoxels used = UsedIn(content.data());
  const size_t labels = content[kMaskBytes];
  const uint8_t* at = content.data() + kMaskBytes + 1;
  voxels->palette.resize(labels);
  if (labels > 0) std::memcpy(voxels->palette.data(), at, labels * sizeof(SegmentLabel));
  at += labels * sizeof(SegmentLabel);
  if (used.count < kBlockVoxels) {
    voxels->distance.fill(0);
    voxels->weight.fill(0);
    voxels->observations.fill(0);
    voxels->color.fill({});
    voxels->slot_label.fill({});
    voxels->slot_votes.fill({});
  }
  ReadPlanes(at, used, voxels);
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
