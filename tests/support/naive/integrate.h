#pragma once

#include <vector>

#include "mapping/integrate.h"

namespace vismap::naive {

/// IntegrateFrame with the voxels one by one: all of all blocks in the box around the view are
/// projected, looked up, judged and fused by plain code on one thread. The same map and the same
/// delta, bit for bit, unless a block has more than 255 labels.
MapDelta IntegrateFrame(const SegmentedFrame& frame, const FrameAssociation& association,
                        const IntegrationOptions& options, SemanticMap* map);

/// All blocks in the axis-aligned box around what the camera sees up to where a frame says
/// something; ascending.
std::vector<BlockIndex> BlocksInView(const FrameHeader& header, const IntegrationOptions& options,
                                     const VoxelMap& voxels);

/// What a frame says of the voxels of a block.
struct BlockSaid {
  int near = 0;  ///< voxels within the truncation of a surface
  int free = 0;  ///< voxels seen empty
};
BlockSaid WhatIsSaid(const SegmentedFrame& frame, const IntegrationOptions& options,
                     const VoxelGridOptions& grid, BlockIndex index);

}  // namespace vismap::naive
