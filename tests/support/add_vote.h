#pragma once

#include "map/label_votes.h"

namespace vismap::testing_support {

/// Adds one vote for a label at a voxel of a block. Returns false when the label got no vote.
inline bool AddVote(SurfaceVoxels& voxels, int voxel, SegmentLabel label) {
  return AddVoteForEntry(voxels, voxel, PaletteEntry(voxels, label));
}

}  // namespace vismap::testing_support
