#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "map/block.h"
#include "map/voxel_map.h"

namespace vismap {

// What lives in this room: the map's free, occupied and unknown space as planners need it, and the
// octrees made of it. The only user of OctoMap (in .cc files). Published methods threshold the
// TSDF at its zero crossing; we keep a voxel of safety on both sides of it, which measured better
// than ray casting into an octree.

enum class CellState : uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2 };

/// States of the 512 voxels of a block: one bit per voxel (bit = linear index). Never both.
struct OccupancyPlanes {
  std::array<uint64_t, kBlockVoxels / 64> free{};
  std::array<uint64_t, kBlockVoxels / 64> occupied{};
  friend bool operator==(const OccupancyPlanes&, const OccupancyPlanes&) = default;
};

/// Occupancy of one 8x8x8 block: one state everywhere, or planes. Immutable, cheap to copy, and
/// equal when the states are equal: a block whose voxels all agree is always held as uniform.
class BlockOccupancy {
 public:
  BlockOccupancy() = default;
  explicit BlockOccupancy(CellState everywhere) : uniform_(everywhere) {}
  /// Throws when a voxel is both free and occupied.
  explicit BlockOccupancy(const OccupancyPlanes& planes);

  bool is_uniform() const { return planes_ == nullptr; }
  bool is(CellState everywhere) const { return is_uniform() && uniform_ == everywhere; }
  CellState At(int offset) const;
  /// The planes, also of a uniform block.
  OccupancyPlanes Planes() const;
  /// The planes of a block that is not uniform; nullptr of a uniform one.
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

/// When a voxel counts as occupied or free. d = signed distance, v = voxel size. What is neither,
/// or was seen too seldom, is unknown.
struct OccupancyOptions {
  double occupied_max_voxels = 1.0;  ///< occupied: d <= this many v, also behind the surface
  double free_min_voxels = 2.0;      ///< free: d >= this many v, or d at the truncation distance
  /// Frames that must have seen the voxel. Space far from surfaces remembers at most two.
  int min_observations = 2;
};

/// Classifies the voxels of one block.
BlockOccupancy ClassifyBlock(const Block& block, const VoxelGridOptions& grid,
                             const OccupancyOptions& options);

}  // namespace vismap
