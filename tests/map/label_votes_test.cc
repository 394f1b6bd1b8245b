#include "map/label_votes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "support/add_vote.h"
#include "support/random_scenes.h"

namespace vismap {
namespace {

using testing_support::AddVote;

int VotesFor(const SurfaceVoxels& voxels, int voxel, SegmentLabel label) {
  for (int slot = 0; slot < kVoteSlots; ++slot) {
    const LabelVote vote = voxels.Vote(voxel, slot);
    if (vote.label == label) return vote.votes;
  }
  return 0;
}

TEST(AddVote, CountsPerVoxelAndLabel) {
  SurfaceVoxels voxels;
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(AddVote(voxels, 7, SegmentLabel{3}));
  EXPECT_TRUE(AddVote(voxels, 7, SegmentLabel{9}));
  EXPECT_EQ(VotesFor(voxels, 7, SegmentLabel{3}), 5);
  EXPECT_EQ(VotesFor(voxels, 7, SegmentLabel{9}), 1);
  EXPECT_EQ(VotesFor(voxels, 8, SegmentLabel{3}), 0);
}

TEST(AddVote, ALateButPersistentLabelWinsThoughAllSlotsWereTaken) {
  SurfaceVoxels voxels;
  for (uint32_t label = 1; label <= 3; ++label) {
    for (int i = 0; i < 4; ++i) AddVote(voxels, 0, SegmentLabel{label});
  }
  for (int i = 0; i < 20; ++i) AddVote(voxels, 0, SegmentLabel{77});
  EXPECT_GT(VotesFor(voxels, 0, SegmentLabel{77}), 10);
}

TEST(AddVote, SaturatesByHalvingAllSlots) {
  SurfaceVoxels voxels;
  for (int i = 0; i < 100; ++i) AddVote(voxels, 0, SegmentLabel{2});
  for (int i = 0; i < 256; ++i) AddVote(voxels, 0, SegmentLabel{1});
  EXPECT_EQ(VotesFor(voxels, 0, SegmentLabel{1}), 128);
  EXPECT_EQ(VotesFor(voxels, 0, SegmentLabel{2}), 50);
}

/// The votes of one voxel without a palette; a label of none marks an empty slot.
class NaiveVotes {
 public:
  bool Add(SegmentLabel label) {
    for (LabelVote& slot : slots_) {
      if (slot.label != label && slot.label != SegmentLabel::kNone) continue;
      slot.label = label;
      if (slot.votes == 255) Halve();
      ++slot.votes;
      return true;
    }
    LabelVote& weakest =
        *std::min_element(slots_.begin(), slots_.end(),
                          [](const LabelVote& a, const LabelVote& b) { return a.votes < b.votes; });
    if (weakest.votes > 1) {
      --weakest.votes;
      return false;
    }
    weakest = {label, 1};
    return true;
  }
  const LabelVote& slot(int i) const { return slots_[static_cast<size_t>(i)]; }

 private:
  void Halve() {
    for (LabelVote& slot : slots_) slot.votes = static_cast<uint8_t>(slot.votes / 2);
  }
  std::array<LabelVote, kVoteSlots> slots_{};
};

TEST(AddVote, EqualsTheNaiveOne) {
  testing_support::RandomNumbers random(1);
  SurfaceVoxels voxels;
  std::array<NaiveVotes, 4> naive;
  int lost = 0;
  for (int i = 0; i < 100000; ++i) {
    const int voxel = random.Whole(0, 3);
    // Few labels get most votes, so that counts reach 255; more labels than slots get some.
    const int label = random.Chance(0.9) ? random.Whole(1, 2) : random.Whole(1, 40);
    const SegmentLabel voted{static_cast<uint32_t>(label)};
    NaiveVotes& expected = naive[static_cast<size_t>(voxel)];
    const bool stored = AddVote(voxels, voxel, voted);
    ASSERT_EQ(stored, expected.Add(voted)) << "vote " << i;
    lost += stored ? 0 : 1;
    for (int slot = 0; slot < kVoteSlots; ++slot) {
      ASSERT_EQ(voxels.Vote(voxel, slot).label, expected.slot(slot).label) << "vote " << i;
      ASSERT_EQ(voxels.Vote(voxel, slot).votes, expected.slot(slot).votes) << "vote " << i;
    }
  }
  EXPECT_GT(lost, 100);
}

TEST(AddVote, KeepsWorkingAfterMoreLabelsThanAPaletteHolds) {
  SurfaceVoxels voxels;
  for (uint32_t label = 1; label <= 2000; ++label) AddVote(voxels, 5, SegmentLabel{label});
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(i < 2 || AddVote(voxels, 6, SegmentLabel{5000}));
  EXPECT_GE(VotesFor(voxels, 6, SegmentLabel{5000}), 18);
  EXPECT_LE(voxels.palette.size(), 255u);
}

}  // namespace
}  // namespace vismap
