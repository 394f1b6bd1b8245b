#pragma once

#include "volume/block.h"

namespace vismap {

/// Adds one vote for `label` at a voxel. With all slots taken by other labels the weakest of them
/// loses a vote, and its place once it has none left (so a late but persistent label wins in the
/// end). Counts halve together at 255. Returns false when the vote was not stored.
bool AddVote(SurfaceVoxels& voxels, int voxel, SegmentLabel label);

}  // namespace vismap
