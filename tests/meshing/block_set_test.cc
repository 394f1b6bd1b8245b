#include "meshing/block_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/random_scenes.h"

namespace vismap {
namespace {

using Set = std::set<BlockIndex>;

// In a small range that includes limits of runs along z: -64, 0, 64.
Set RandomBlocks(testing_support::RandomNumbers* random) {
  Set blocks;
  for (int i = random->Whole(0, 60); i > 0; --i)
    blocks.insert({random->Whole(-3, 3), random->Whole(-3, 3), random->Whole(-70, 70)});
  return blocks;
}

Set FarApart(const Set& blocks) {
  constexpr int kFar = 80'000'000;
  Set apart;
  for (const auto& [x, y, z] : blocks) apart.insert({kFar * x, kFar * y, 50'000 * z});
  return apart;
}

BlockSet ToBlockSet(const Set& blocks) {
  std::vector<BlockIndex> descending(blocks.rbegin(), blocks.rend());
  descending.insert(descending.end(), blocks.begin(), blocks.end());
  return BlockSet(descending);
}

Set ToSet(const BlockSet& blocks) {
  const std::vector<BlockIndex> list = blocks.Blocks();
  EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
  EXPECT_EQ(list.size(), blocks.size());
  return {list.begin(), list.end()};
}

Set Grown(const Set& blocks, int below, int above) {
  Set grown;
  for (const BlockIndex& block : blocks) {
    for (int x = -below; x <= above; ++x) {
      for (int y = -below; y <= above; ++y) {
        for (int z = -below; z <= above; ++z) grown.insert({block.x + x, block.y + y, block.z + z});
      }
    }
  }
  return grown;
}

TEST(BlockSet, DoesWhatSetsOfBlocksDo) {
  testing_support::RandomNumbers random(3);
  for (int round = 0; round < 200; ++round) {
    const Set a = RandomBlocks(&random), b = RandomBlocks(&random);
    EXPECT_EQ(ToSet(ToBlockSet(a)), a);
    for (const int below : {0, 1}) {
      for (const int above : {0, 1})
        EXPECT_EQ(ToSet(ToBlockSet(a).Grown(below, above)), Grown(a, below, above));
    }
    Set both = a, common;
    both.insert(b.begin(), b.end());
    for (const BlockIndex& block : a) {
      if (b.contains(block)) common.insert(block);
    }
    EXPECT_EQ(ToSet(ToBlockSet(a).Union(ToBlockSet(b))), both);
    EXPECT_EQ(ToSet(ToBlockSet(a).Intersection(ToBlockSet(b))), common);
  }
}

TEST(BlockSet, KnowsWhatChangesAffect) {
  testing_support::RandomNumbers random(4);
  for (int round = 0; round < 200; ++round) {
    Set changed = RandomBlocks(&random);
    if (round % 4 == 0) changed = FarApart(changed);
    const std::vector<BlockIndex> blocks(changed.begin(), changed.end());
    std::vector<NeighbourBits> affected;
    Set expected;
    for (const BlockIndex& block : blocks) {
      affected.push_back(static_cast<NeighbourBits>(random.Whole(0, int{kAllNeighbours})));
      for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
          for (int z = -1; z <= 1; ++z) {
            if (affected.back() >> NeighbourSlot(x, y, z) & 1)
              expected.insert({block.x + x, block.y + y, block.z + z});
          }
        }
      }
    }
    EXPECT_EQ(ToSet(BlockSet::AffectedBy({blocks, affected})), expected);
    EXPECT_EQ(ToSet(BlockSet::AffectedBy(blocks)), Grown(changed, 1, 1));
  }
}

}  // namespace
}  // namespace vismap
