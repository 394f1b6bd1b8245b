#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/ids.h"
#include "geometry/image.h"
#include "map/shared.h"

namespace vismap {

inline constexpr int kBlockSide = 8;
inline constexpr int kBlockVoxels = kBlockSide * kBlockSide * kBlockSide;
inline constexpr int kVoteSlots = 3;
/// The truncation distance in the steps in which voxels store their distance.
inline constexpr int kTruncationSteps = 32767;

/// Position of a block in the grid of blocks: it covers voxels 8 i to 8 i + 7 along each axis of W.
struct BlockIndex {
  int32_t x = 0, y = 0, z = 0;
  friend auto operator<=>(const BlockIndex&, const BlockIndex&) = default;
};

/// Position of a voxel in the grid of voxels: it covers [i v, (i + 1) v) along each axis of W, v =
/// voxel size [m]; its centre is at (i + 0.5) v.
struct VoxelIndex {
  int32_t x = 0, y = 0, z = 0;
  friend auto operator<=>(const VoxelIndex&, const VoxelIndex&) = default;
};

/// Offset of a voxel in its block, 0..511: x fastest, z slowest.
constexpr int LinearIndex(int x, int y, int z) { return x + kBlockSide * (y + kBlockSide * z); }

constexpr BlockIndex BlockOf(VoxelIndex v) { return {v.x >> 3, v.y >> 3, v.z >> 3}; }
constexpr int OffsetInBlock(VoxelIndex v) { return LinearIndex(v.x & 7, v.y & 7, v.z & 7); }
/// The voxel with this offset in a block.
constexpr VoxelIndex VoxelAt(BlockIndex block, int offset) {
  return {kBlockSide * block.x + (offset & 7), kBlockSide * block.y + ((offset >> 3) & 7),
          kBlockSide * block.z + (offset >> 6)};
}

/// A set of voxels of a block, one bit each: word z holds the layer at z, bit x + 8 y.
using VoxelBits = std::array<uint64_t, kBlockVoxels / 64>;

/// Hash for tables with blocks as keys. The order of such a table must never reach an output.
struct BlockIndexHash {
  size_t operator()(const BlockIndex& b) const {
    uint64_t h = static_cast<uint32_t>(b.x) * 0x9E3779B185EBCA87ull;
    h ^= static_cast<uint32_t>(b.y) * 0xC2B2AE3D27D4EB4Full + (h << 6) + (h >> 2);
    h ^= static_cast<uint32_t>(b.z) * 0x165667B19E3779F9ull + (h << 6) + (h >> 2);
    return static_cast<size_t>(h ^ (h >> 29));
  }
};

/// Votes of a voxel for a label, one per frame. kNone = empty slot.
struct LabelVote {
  SegmentLabel label = SegmentLabel::kNone;
  uint8_t votes = 0;
};

/// All voxels of a block that a surface passes through, or near to: within the truncation distance.
struct SurfaceVoxels {
  // These come from slabs of their own: on the common heap they would leave gaps when they are
  // packed, into which nothing fits.
  static void* operator new(size_t size);
  static void operator delete(void* voxels) noexcept;  // NOLINT: slots have one size

  /// Truncated signed distance in steps of truncation / kTruncationSteps; positive in front of the
  /// surface.
  std::array<int16_t, kBlockVoxels> distance{};
  /// Integration weight in steps of 1/kWeightScale (1 = one observation at 1 m); 0 = never
  /// observed.
  std::array<uint16_t, kBlockVoxels> weight{};
  /// Number of frames that observed the voxel, at most 255.
  std::array<uint8_t, kBlockVoxels> observations{};
  std::array<Rgb8, kBlockVoxels> color{};

  /// Label votes: up to kVoteSlots per voxel, as 1-based indices into `palette` (0 = empty slot)
  /// and vote counts that halve together when one reaches 255.
  std::array<std::array<uint8_t, kVoteSlots>, kBlockVoxels> slot_label{};
  std::array<std::array<uint8_t, kVoteSlots>, kBlockVoxels> slot_votes{};
  std::vector<SegmentLabel> palette;  ///< the distinct labels in this block, at most 255

  LabelVote Vote(int voxel, int slot) const {
    const uint8_t entry = slot_label[static_cast<size_t>(voxel)][static_cast<size_t>(slot)];
    if (entry == 0) return {};
    return {palette[entry - 1u], slot_votes[static_cast<size_t>(voxel)][static_cast<size_t>(slot)]};
  }
};

inline constexpr float kWeightScale = 128.0F;

/// The voxels of a block far from all surfaces that were seen empty at least once, and at least
/// twice: one bit each, by linear index. 128 bytes instead of 7 kB.
struct FreeVoxels {
  VoxelBits once{};
  VoxelBits twice{};

  bool SeenOnce(int voxel) const {
    return (once[static_cast<size_t>(voxel) / 64] >> (voxel % 64)) & 1;
  }
  bool SeenTwice(int voxel) const {
    return (twice[static_cast<size_t>(voxel) / 64] >> (voxel % 64)) & 1;
  }
  friend bool operator==(const FreeVoxels&, const FreeVoxels&) = default;
};

/// How many frames had a reading of something thin end in each voxel of a block, less when rays
/// passed the voxel clearly. Thin things are lost in the mean of the distance, since most rays
/// through the centres of voxels pass beside them.
struct ThinVoxels {
  static constexpr uint8_t kMost = 12;  ///< more frames are not counted
  std::array<uint8_t, kBlockVoxels> hits{};
  friend bool operator==(const ThinVoxels&, const ThinVoxels&) = default;
};

/// Bytes that do not change and that copies share.
class SharedBytes {
 public:
  SharedBytes() = default;
  explicit SharedBytes(std::span<const uint8_t> content);
  SharedBytes(const SharedBytes& other) noexcept;
  SharedBytes(SharedBytes&& other) noexcept : head_(std::exchange(other.head_, nullptr)) {}
  SharedBytes& operator=(SharedBytes other) noexcept {
    std::swap(head_, other.head_);
    return *this;
  }
  ~SharedBytes();

  explicit operator bool() const { return head_ != nullptr; }
  /// There must be some.
  std::span<const uint8_t> content() const;
  /// The memory that they take [bytes].
  size_t bytes() const;

 private:
  struct Head;
  Head* head_ = nullptr;  // before the content; nullptr = there is none
};

/// Owns the voxels of a block near a surface: as they are or, while no camera sees them, packed to
/// about a fifth of their size without loss. To read them use a SurfaceReader
/// (map/surface_reader.h); to change them call Unpack first. Copies share the voxels until one of
/// them changes them, see Shared.
class SurfaceHolder {
 public:
  SurfaceHolder() = default;
  SurfaceHolder& operator=(Shared<SurfaceVoxels> voxels) {
    voxels_ = std::move(voxels);
    packed_ = {};
    return *this;
  }

  /// Whether there are voxels, packed or not.
  explicit operator bool() const { return voxels_ || packed_; }
  bool packed() const { return static_cast<bool>(packed_); }
  /// The voxels; nullptr when they are packed or there are none.
  const SurfaceVoxels* get() const { return voxels_.get(); }
  /// Only for voxels that are not packed.
  const SurfaceVoxels& operator*() const { return *voxels_; }
  const SurfaceVoxels* operator->() const { return voxels_.get(); }
  SurfaceVoxels& operator*() { return voxels_.Own(); }
  SurfaceVoxels* operator->() { return &voxels_.Own(); }

  /// Does nothing when the voxels are packed or there are none.
  void Pack();
  /// Does nothing unless the voxels are packed.
  void Unpack();
  /// Unpacks a copy. Throws std::logic_error unless the voxels are packed.
  void CopyTo(SurfaceVoxels* voxels) const;
  /// Size of the packed voxels [bytes]; 0 unless they are packed.
  size_t packed_bytes() const;

 private:
  Shared<SurfaceVoxels> voxels_;
  SharedBytes packed_;
};

/// One block of the map, of one of three kinds: near a surface (`surface`), partly seen empty
/// (`free`), or seen empty everywhere at least twice (`all_free`). Blocks that the map does not
/// hold are unseen. Copies share their voxels until one of them changes them, see Shared.
struct Block {
  SurfaceHolder surface;
  Shared<FreeVoxels> free;
  Shared<ThinVoxels> thin;  ///< of a block of any kind; mostly there is none
  uint32_t last_used = 0;  ///< revision that last changed the surface; 0 = none since it was packed
  bool all_free = false;
};

}  // namespace vismap
