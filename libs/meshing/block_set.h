#pragma once

#include <compare>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "map/block_rim.h"

namespace vismap {

/// A set of blocks, as bits along z: unions and neighbourhoods of thousands of blocks take
/// microseconds.
class BlockSet {
 public:
  BlockSet() = default;
  /// In any order, any number of times.
  explicit BlockSet(std::span<const BlockIndex> blocks);

  /// The blocks whose surface depends on what changed.
  static BlockSet AffectedBy(const BlockChanges& changes);

  /// With every block also those up to `below` lower and `above` higher along each axis; 0 or 1.
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
  // Runs that are moved by a step along x or y.
  struct Moved {
    std::span<const Run> runs;
    BlockIndex step;
  };
  static BlockSet AffectedBy(std::span<const BlockIndex> changed,
                             std::span<const NeighbourBits> affected);
  static BlockSet Merge(std::initializer_list<Moved> parts);
  // Behind all runs, or to the last one.
  void Append(const BlockIndex& at, uint64_t bits);
  // Anywhere, but not far from the end.
  void Put(const BlockIndex& at, uint64_t bits);
  // Puts bits a step lower along z, others as they are, and others a step higher.
  void PutStepped(const BlockIndex& at, uint64_t down, uint64_t still, uint64_t up);
  BlockSet GrownAlongZ(int below, int above) const;
  BlockSet GrownAside(const BlockIndex& step, int below, int above) const;

  std::vector<Run> runs_;  // ascending; none without bits
};

}  // namespace vismap
