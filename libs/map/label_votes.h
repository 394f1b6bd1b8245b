#pragma once

#include "map/block.h"

namespace vismap {

/// The palette entry of a label, for AddVoteForEntry; it is added when it is new. 0 = the palette
/// is full of labels in use. Entries of other labels may change by this call.
uint8_t PaletteEntry(SurfaceVoxels& voxels, SegmentLabel label);

/// Adds one vote for the label of a palette entry at a voxel, which counts the votes of up to
/// kVoteSlots labels.
/// If the label has a slot, or one is empty: votes[slot] <- votes[slot] + 1. When votes[slot] is
/// 255, the votes of all slots are halved first, rounded down.
/// Otherwise the slot with the fewest votes, the first of several, loses one. If it had only one,
/// the label takes the slot, with one vote. So a late but persistent label wins in the end.
/// Returns false when the label got no vote, and for entry 0. Twin: NaiveVotes in
/// tests/map/label_votes_test.cc, held equal by AddVote.EqualsTheNaiveOne.
bool AddVoteForEntry(SurfaceVoxels& voxels, int voxel, uint8_t entry);

}  // namespace vismap
