#include "map/label_votes.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

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

TEST(AddVote, KeepsWorkingAfterMoreLabelsThanAPaletteHolds) {
  SurfaceVoxels voxels;
  for (uint32_t label = 1; label <= 2000; ++label) AddVote(voxels, 5, SegmentLabel{label});
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(i < 2 || AddVote(voxels, 6, SegmentLabel{5000}));
  EXPECT_GE(VotesFor(voxels, 6, SegmentLabel{5000}), 18);
  EXPECT_LE(voxels.palette.size(), 255u);
}

}  // namespace
}  // namespace vismap
