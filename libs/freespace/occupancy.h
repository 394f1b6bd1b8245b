#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "map/block.h"
#include "map/voxel_map.h"

namespace vismap {

// This room classifies the map into free, occupied and unknown space for planners, and makes
// octrees of it. The method is described in libs/METHOD.md, Free space.

enum class CellState : uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2 };

/// States of the 512 voxels of a block: one bit per voxel, by linear index. No voxel has both.
struct OccupancyPlanes {
  std::array<uint64_t, kBlockVoxels / 64> free{};
  std::array<uint64_t, kBlockVoxels / 64> occupied{};
  friend bool operator==(const OccupancyPlanes&, const OccupancyPlanes&) = default;
};

/// Occupancy of one block of 8x8x8 voxels: uniform, or planes. Immutable and cheap to copy. A block
/// whose voxels all have one state is always uniform, so that blocks are equal if their states are.
class BlockOccupancy {
 public:
  BlockOccupancy() = default;
  explicit BlockOccupancy(CellState everywhere) : uniform_(everywhere) {}
  /// Throws std::logic_error when a voxel is both free and occupied.
  explicit BlockOccupancy(const OccupancyPlanes& planes);

  bool is_uniform() const { return planes_ == nullptr; }
  /// Whether all voxels have this state.
  bool is(CellState everywhere) const { return is_uniform() && uniform_ == everywhere; }
  CellState At(int offset) const;
  /// The planes, also of a uniform block.
  OccupancyPlanes Planes() const;
  /// The planes of a block that is not uniform; nullptr for a uniform one.
  const OccupancyPlanes* mixed() const { return planes_.get(); }
  CellState uniform_state() const { return uniform_; }

  friend bool operator==(const BlockOccupancy& a, const BlockOccupancy& b) {
    if (a.is_uniform() || b.is_uniform())
      return a.is_uniform() && b.is_uniform() && a.uniform_ == b.uniform_;
    return a.planes_ == b.planes_ || *a.planes_ == *b.planes_;
  }

 private:
  CellState uniform_ = CellState::kUnknown;
  std::shared_ptr<const OccupancyPlanes> planes_;
};

/// When a voxel counts as occupied or free, by its signed distance d and the voxel size v. All
/// other voxels are unknown. See libs/METHOD.md, Free space.
struct OccupancyOptions {
  double occupied_max_voxels = 1.0;  ///< occupied: d <= this many v, also behind the surface
  double free_min_voxels = 2.0;      ///< free: d >= this many v, or d = the truncation distance
  /// Frames that must have seen the voxel. Voxels far from surfaces count only to two.
  int min_observations = 2;
  /// A voxel with so many hits of something thin (ThinVoxels) is occupied, whatever its distance; 0
  /// = hits do not count.
  int thin_hits = 3;
};

/// Classifies the voxels of one block.
BlockOccupancy ClassifyBlock(const Block& block, const VoxelGridOptions& grid,
                             const OccupancyOptions& options);

}  // namespace vismap
