#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "map/block_table.h"

namespace vismap {

/// The blocks with min <= index < max along each axis.
struct BlockRegion {
  BlockIndex min, max;

  /// Number of blocks. Differences of the indices may not fit their type.
  double size() const {
    return (double{1} * max.x - min.x) * (double{1} * max.y - min.y) * (double{1} * max.z - min.z);
  }
  bool Contains(BlockIndex block) const {
    return block.x >= min.x && block.x < max.x && block.y >= min.y && block.y < max.y &&
           block.z >= min.z && block.z < max.z;
  }
};

/// The blocks that a box [m] touches, or that are less than `margin` [m] from it. The corners of
/// the box must be finite.
inline BlockRegion RegionAround(const Eigen::AlignedBox3d& box_W, double margin,
                                double block_size) {
  constexpr double kMost = 1 << 30;
  const auto index = [&](double at) { return static_cast<int32_t>(std::clamp(at, -kMost, kMost)); };
  const Eigen::Array3d low = ((box_W.min().array() - margin) / block_size).floor();
  const Eigen::Array3d high = ((box_W.max().array() + margin) / block_size).ceil();
  return {{index(low.x()), index(low.y()), index(low.z())},
          {index(high.x()), index(high.y()), index(high.z())}};
}

/// The blocks of a region that have a value, in ascending order. Takes time in proportion to the
/// region or to the table, whichever is smaller.
template <typename Value>
std::vector<BlockIndex> BlocksIn(const BlockTable<Value>& table, const BlockRegion& region) {
  std::vector<BlockIndex> blocks;
  if (region.size() > static_cast<double>(table.size())) {
    table.ForEach([&](BlockIndex block, const Value&) {
      if (region.Contains(block)) blocks.push_back(block);
    });
    std::sort(blocks.begin(), blocks.end());
    return blocks;
  }
  typename BlockTable<Value>::Reader reader(table);
  for (BlockIndex at = region.min; at.x < region.max.x; ++at.x) {
    for (at.y = region.min.y; at.y < region.max.y; ++at.y) {
      for (at.z = region.min.z; at.z < region.max.z; ++at.z) {
        if (reader.Find(at) != nullptr) blocks.push_back(at);
      }
    }
  }
  return blocks;
}

}  // namespace vismap
