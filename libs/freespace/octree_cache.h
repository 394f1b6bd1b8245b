#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "freespace/octree_nodes.h"

namespace vismap {

/// Encodes a map whose cells are an octree's leaves, again and again while it changes: keeps the
/// bytes of every cube of 32^3 leaves, and writes only those again whose leaves changed, or that
/// the bounds cut differently. What is left to do for all of a map is to copy them together.
class OctreeCache {
 public:
  /// Says which blocks of `leaves` are different from the last time, or may be.
  void Update(const OccupancyMap& leaves, std::span<const BlockIndex> changed);

  /// The octree. `leaves` must be as at the last Update.
  Result<OctreeBytes> Encode(const OccupancyMap& leaves, double resolution, UnknownPolicy unknown,
                             const std::optional<Eigen::AlignedBox3d>& bounds_W);

  size_t cubes() const { return cubes_.size(); }  ///< of which anything is known
  int64_t encoded() const { return encoded_; }    ///< cubes written by the last Encode

 private:
  struct Written {
    std::optional<OccupancyBox> box;  ///< that it was written for; none = not up to date
    Subtree subtree;
  };
  struct Cube {
    OctreeCube place;
    OccupancyBox known;              ///< the smallest box around its leaves that are not unknown
    std::array<Written, 2> written;  ///< by UnknownPolicy
  };

  std::optional<OccupancyBox> KnownCells() const;
  void EncodeChanged(const OccupancyMap& leaves, const OccupancyBox& box, UnknownPolicy unknown);

  std::map<uint64_t, Cube> cubes_;    // by place in depth-first order
  std::set<BlockIndex> unreachable_;  // known blocks outside of OctoMap's key space
  int64_t encoded_ = 0;
};

}  // namespace vismap
