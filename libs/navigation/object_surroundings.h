#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <vector>

#include "freespace/occupancy.h"
#include "map/semantic_map.h"
#include "navigation/support_planes.h"

namespace vismap {

/// Which surface a voxel belongs to: none, that of the objects in question, or, from 2 on, that of
/// another label; with more than 254 of these, several share the last number.
inline constexpr uint8_t kNoSurface = 0, kObjectSurface = 1;

/// A block near the objects in question.
struct SurroundingBlock {
  BlockIndex index;
  OccupancyPlanes plain;                        ///< free and occupied space with the objects
  std::array<uint8_t, kBlockVoxels> surface{};  ///< by voxel
  VoxelBits band{};   ///< occupied, or seen nearer to a surface than free space begins
  VoxelBits voted{};  ///< of those: with votes of their own
  std::vector<SurfaceSample> samples;  ///< of other surfaces
  bool has_object = false;             ///< any voxel votes for the objects
};

/// Reads the blocks of a map that are near the objects with some labels.
class SurroundingsReader {
 public:
  /// `labels`: those of the objects, alive or merged. The map must outlive it.
  SurroundingsReader(const SemanticMap& map, std::span<const SegmentLabel> labels,
                     const OccupancyOptions& options);
  SurroundingBlock Read(BlockIndex index);

 private:
  uint8_t NumberOf(SegmentLabel label);
  void ReadVoxels(const SurfaceVoxels& voxels, SurroundingBlock* block);

  const SemanticMap& map_;
  OccupancyOptions options_;
  int free_min_;                              // in steps of SurfaceVoxels::distance
  std::map<SegmentLabel, uint8_t> surfaces_;  // of canonical labels
};

/// A voxel in the blocks of a NearSpace; negative = in none of them.
using NearVoxel = int32_t;

/// The blocks around some objects, with access from voxel to voxel.
class NearSpace {
 public:
  explicit NearSpace(std::vector<SurroundingBlock> blocks);

  /// The voxel that is this far away along each axis, at most 8.
  NearVoxel Beside(NearVoxel voxel, int dx, int dy, int dz) const;
  /// Calls `visit` for the six voxels beside one.
  template <typename Visit>
  void ForSides(NearVoxel voxel, const Visit& visit) const {
    for (const auto& [dx, dy, dz] : kSides) visit(Beside(voxel, dx, dy, dz));
  }
  /// Calls `visit` for all voxels of the objects, ascending.
  template <typename Visit>
  void ForObject(const Visit& visit) const {
    for (size_t i = 0; i < blocks_.size(); ++i) {
      const auto& surface = blocks_[i].surface;
      if (std::memchr(surface.data(), kObjectSurface, surface.size()) == nullptr) continue;
      for (size_t offset = 0; offset < surface.size(); ++offset) {
        if (surface[offset] == kObjectSurface)
          visit(static_cast<NearVoxel>(i * kBlockVoxels + offset));
      }
    }
  }
  VoxelIndex IndexOf(NearVoxel voxel) const;
  Eigen::Vector3f PlaceOf(NearVoxel voxel) const;  ///< its centre [voxels]

  SurroundingBlock& BlockOf(NearVoxel voxel) { return blocks_[static_cast<size_t>(voxel) / 512]; }
  const SurroundingBlock& BlockOf(NearVoxel voxel) const {
    return blocks_[static_cast<size_t>(voxel) / 512];
  }
  uint8_t& Surface(NearVoxel voxel) {
    return BlockOf(voxel).surface[static_cast<size_t>(voxel) % 512];
  }
  uint8_t Surface(NearVoxel voxel) const {
    return BlockOf(voxel).surface[static_cast<size_t>(voxel) % 512];
  }
  bool InBand(NearVoxel voxel) const { return Bit(BlockOf(voxel).band, voxel); }
  bool Voted(NearVoxel voxel) const { return Bit(BlockOf(voxel).voted, voxel); }
  bool IsFree(NearVoxel voxel) const { return Bit(BlockOf(voxel).plain.free, voxel); }
  bool IsOccupied(NearVoxel voxel) const { return Bit(BlockOf(voxel).plain.occupied, voxel); }
  /// Unknown, and no surface is near.
  bool IsUnseen(NearVoxel voxel) const {
    return !IsFree(voxel) && !IsOccupied(voxel) && !InBand(voxel);
  }

  const std::vector<SurroundingBlock>& blocks() const { return blocks_; }
  NearVoxel size() const { return static_cast<NearVoxel>(blocks_.size() * kBlockVoxels); }

  /// Voxels of the band without votes get the surface of the nearest ones that have votes, within
  /// eight steps; other surfaces come before the objects'.
  void SpreadSurfaces();

 private:
  static constexpr int kSides[6][3] = {{-1, 0, 0}, {1, 0, 0},  {0, -1, 0},
                                       {0, 1, 0},  {0, 0, -1}, {0, 0, 1}};
  static bool Bit(const VoxelBits& bits, NearVoxel voxel) {
    const auto offset = static_cast<size_t>(voxel) % 512;
    return ((bits[offset / 64] >> (offset % 64)) & 1) != 0;
  }

  std::vector<SurroundingBlock> blocks_;
  std::vector<std::array<int32_t, 27>> beside_;  // the block at x + 3 y + 9 z; -1 = none
};

}  // namespace vismap
