#pragma once

#include <compare>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "map/block_rim.h"

namespace vismap {

/// A set of blocks, stored as bits along z, so that unions and neighbourhoods of thousands of
/// blocks take microseconds.
class BlockSet {
 public:
  BlockSet() = default;
  /// `blocks` in any order, with repetitions.
  explicit BlockSet(std::span<const BlockIndex> blocks);

  /// The blocks whose mesh depends on the changes.
  static BlockSet AffectedBy(const BlockChanges& changes);

  /// The set and all blocks up to `below` lower or `above` higher along each axis; both 0 or 1.
  BlockSet Grown(int below, int above) const;
  BlockSet Union(const BlockSet& other) const;
  BlockSet Intersection(const BlockSet& other) const;

  size_t size() const;
  /// Ascending.
  std::vector<BlockIndex> Blocks() const;

 private:
  // The blocks (x, y, 64 z + i) of which bit i is set.
  struct Run {
    BlockIndex at;
    uint64_t bits;
  };
  // Runs, moved by a step along x or y.
  struct Moved {
    std::span<const Run> runs;
    BlockIndex step;
  };
  static BlockSet AffectedBy(std::span<const BlockIndex> changed,
                             std::span<const NeighbourBits> affected);
  static BlockSet Merge(std::initializer_list<Moved> parts);
  // Adds bits to the last run or to a new one behind it.
  void Append(const BlockIndex& at, uint64_t bits);
  // Adds bits to a run near the end, or to a new one there.
  void Put(const BlockIndex& at, uint64_t bits);
  // Adds `down` one step lower along z, `still` at its place, and `up` one step higher.
  void PutStepped(const BlockIndex& at, uint64_t down, uint64_t still, uint64_t up);
  BlockSet GrownAlongZ(int below, int above) const;
  BlockSet GrownAside(const BlockIndex& step, int below, int above) const;

  std::vector<Run> runs_;  // ascending; each has bits
};

}  // namespace vismap
