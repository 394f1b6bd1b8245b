#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "geometry/frame.h"
#include "map/block.h"
#include "mapping/depth_pyramid.h"

namespace vismap {

/// The ranges in which a frame can change blocks.
struct VisibilityOptions {
  double block_size = 0.08;       ///< [m]
  double truncation = 0.04;       ///< [m]
  double min_range = 0.1;         ///< [m along z]
  double max_range = 5.0;         ///< of surfaces [m along z]
  double free_space_range = 5.0;  ///< [m along z]
  bool free_space = true;
  /// The search ends once it has found more than this, see FrameCost.
  size_t max_cost = std::numeric_limits<size_t>::max();
};

/// What a frame can change in a block.
enum class BlockVisibility : uint8_t {
  kNothing,     ///< nothing: the block is out of view, hidden or out of range
  kMixed,       ///< a surface may pass near it
  kPartlyFree,  ///< no surface is near; voxels that project to measured pixels are seen empty
  kWhollyFree,  ///< no surface is near; all voxels project to measured pixels and are seen empty
};

/// A block that the frame may change.
struct VisibleBlock {
  BlockIndex index;
  BlockVisibility view = BlockVisibility::kMixed;
};

/// What it takes to change a block that a surface may pass near; one in free space costs 1.
inline constexpr size_t kCostPerBlock = 16;

/// What it takes to change blocks.
size_t FrameCost(const std::vector<VisibleBlock>& visible);

/// The blocks that the frame may change, ascending: those that a surface may pass near, and those
/// in which it sees free space. When they cost more than options.max_cost, only so many of them
/// that their cost is above it. Blocks for which `wanted` returns false are left out; several
/// threads call it at the same time. Found by descending an octree over the view.
std::vector<VisibleBlock> FindVisibleBlocks(
    const FrameHeader& header, const DepthPyramid& pyramid, const VisibilityOptions& options,
    const std::function<bool(const VisibleBlock&)>& wanted = [](const VisibleBlock&) {
      return true;
    });

}  // namespace vismap
