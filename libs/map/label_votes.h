#pragma once

#include "map/block.h"

namespace vismap {

/// Adds one vote for `label` at a voxel. With all slots taken by other labels the weakest of them
/// loses a vote, and its place once it has none left (so a late but persistent label wins in the
/// end). Counts halve together at 255. Returns false when the vote was not stored.
bool AddVote(SurfaceVoxels& voxels, int voxel, SegmentLabel label);

/// The two halves of AddVote, for many votes for one label: its palette entry, added when new (0 =
/// the palette is full of labels in use; the vote is lost), which holds until another label's is
/// asked for; and the vote itself.
uint8_t PaletteEntry(SurfaceVoxels& voxels, SegmentLabel label);
bool AddVoteForEntry(SurfaceVoxels& voxels, int voxel, uint8_t entry);

}  // namespace vismap
