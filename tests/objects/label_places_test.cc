#include "objects/label_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "support/analytic_room.h"

namespace vismap {
namespace {

using ::testing::IsSupersetOf;
using ::testing::UnorderedElementsAreArray;
using testing_support::AnalyticRoom;
using testing_support::kBall;
using testing_support::kBoxLeft;
using testing_support::kFloor;

std::vector<BlockIndex> BlocksWith(const SemanticMap& map, SegmentLabel label) {
  std::vector<BlockIndex> blocks;
  for (const BlockIndex& index : map.voxels.SortedIndices()) {
    const Block& block = *map.voxels.Find(index);
    if (!block.surface) continue;
    const auto& palette = block.surface->palette;
    if (std::find(palette.begin(), palette.end(), label) != palette.end()) blocks.push_back(index);
  }
  return blocks;
}

TEST(LabelPlaces, AreTheBlocksWithVotesForALabel) {
  const SemanticMap map = AnalyticRoom();
  LabelPlaces places;
  EXPECT_TRUE(places.BlocksOf(kBall).empty());
  places.AddBlocks(map.voxels, map.voxels.SortedIndices());
  for (const SegmentLabel label : {kFloor, kBoxLeft, kBall}) {
    EXPECT_FALSE(BlocksWith(map, label).empty());
    EXPECT_THAT(places.BlocksOf(label), UnorderedElementsAreArray(BlocksWith(map, label)));
  }
  places.AddBlocks(map.voxels, map.voxels.SortedIndices());
  EXPECT_THAT(places.BlocksOf(kBall), UnorderedElementsAreArray(BlocksWith(map, kBall)))
      << "a block that has no new labels adds nothing";
  places.Clear();
  EXPECT_TRUE(places.BlocksOf(kBall).empty());
}

TEST(LabelPlaces, ABlockIsAddedForItsNewLabels) {
  SemanticMap map = AnalyticRoom();
  LabelPlaces places;
  places.AddBlocks(map.voxels, map.voxels.SortedIndices());
  const BlockIndex block = BlocksWith(map, kFloor).front();
  const SegmentLabel fresh{9};
  map.voxels.FindMutable(block)->surface->palette.push_back(fresh);
  places.AddBlocks(map.voxels, std::span(&block, 1));
  EXPECT_THAT(places.BlocksOf(fresh), ::testing::ElementsAre(block));
}

TEST(LabelPlaces, ASurvivorHasTheBlocksOfBothLabels) {
  SemanticMap map = AnalyticRoom();
  LabelPlaces as_they_merge, from_the_table;
  as_they_merge.AddBlocks(map.voxels, map.voxels.SortedIndices());
  from_the_table.AddBlocks(map.voxels, map.voxels.SortedIndices());
  // In a chain: the ball into the box, the box into the floor.
  for (const auto& [dead, survivor] : {std::pair(kBall, kBoxLeft), std::pair(kBoxLeft, kFloor)}) {
    EXPECT_EQ(map.labels.Merge(dead, survivor), survivor);
    as_they_merge.Merge(dead, survivor);
  }
  from_the_table.MergeAll(map.labels);
  for (const LabelPlaces* places : {&as_they_merge, &from_the_table}) {
    for (const SegmentLabel label : {kFloor, kBoxLeft, kBall})
      EXPECT_THAT(places->BlocksOf(kFloor), IsSupersetOf(BlocksWith(map, label)));
  }
}

}  // namespace
}  // namespace vismap
