#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "freespace/octree_nodes.h"

namespace vismap {

/// Encodes a map whose cells are the leaves of an octree, repeatedly while it changes. Keeps the
/// bytes of every cube of 32^3 leaves. Encode writes only cubes again whose leaves changed or that
/// the bounds cut differently, and then copies the bytes of all cubes to one tree.
class OctreeCache {
 public:
  /// Must be called with the blocks of `leaves` that may have changed since the last call.
  void Update(const OccupancyMap& leaves, std::span<const BlockIndex> changed);

  /// The octree. `leaves` must be as at the last Update, and `options.resolution_m` their edge.
  /// `options.free_fraction` is not used.
  Result<OctreeBytes> Encode(const OccupancyMap& leaves, const OctreeOptions& options);

  int64_t encoded() const { return encoded_; }  ///< cubes written by the last Encode

 private:
  struct Written {
    std::optional<OctreeExtent> extent;  ///< its part in the cube; nullopt = not up to date
    Subtree subtree;
  };
  struct Cube {
    OctreeCube place;
    OccupancyBox known;              ///< the smallest box around its leaves that are not unknown
    std::array<Written, 2> written;  ///< indexed by UnknownPolicy
  };

  std::optional<OccupancyBox> KnownCells() const;
  Result<std::optional<OccupancyBox>> BoxOf(const OctreeOptions& options) const;
  NodeWriter EncodeWithin(const OccupancyMap& leaves, const OctreeExtent& extent,
                          UnknownPolicy unknown);
  std::string LeftOut(bool shell_is_cut, double resolution) const;
  void EncodeChanged(const OccupancyMap& leaves, const OctreeExtent& extent, UnknownPolicy unknown);

  std::map<uint64_t, Cube> cubes_;    // by OctreeOrder
  std::set<BlockIndex> unreachable_;  // known blocks outside OctoMap's key space
  int64_t encoded_ = 0;
};

}  // namespace vismap
