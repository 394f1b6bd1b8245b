#pragma once

#include "map/block.h"

namespace vismap {

/// Adds one vote for `label` at a voxel, which counts the votes of up to kVoteSlots labels.
/// If the label has a slot, or one is empty: votes[slot] <- votes[slot] + 1. When votes[slot] is
/// 255, the votes of all slots are halved first, rounded down.
/// Otherwise the slot with the fewest votes, the first of several, loses one. If it had only one,
/// the label takes the slot, with one vote. So a late but persistent label wins in the end.
/// Returns false when the label got no vote. Twin: NaiveVotes in tests/map/label_votes_test.cc,
/// held equal by AddVote.EqualsTheNaiveOne.
bool AddVote(SurfaceVoxels& voxels, int voxel, SegmentLabel label);

/// The first half of AddVote, for callers with many votes for one label: the label's palette entry,
/// added when it is new; 0 = the palette is full of labels in use. Entries of other labels may
/// change by this call.
uint8_t PaletteEntry(SurfaceVoxels& voxels, SegmentLabel label);
/// The second half of AddVote: one vote for the label of a palette entry. False for entry 0.
bool AddVoteForEntry(SurfaceVoxels& voxels, int voxel, uint8_t entry);

}  // namespace vismap
