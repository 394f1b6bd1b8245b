#include "map/block_table.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>

namespace vismap {
namespace {

// A value that cannot be copied and owns memory, like a block, which owns voxels.
using Owner = std::unique_ptr<int>;

std::map<BlockIndex, int> Contents(const BlockTable<Owner>& table) {
  std::map<BlockIndex, int> contents;
  table.ForEach([&](BlockIndex index, const Owner& value) {
    EXPECT_TRUE(contents.emplace(index, value == nullptr ? -1 : *value).second);
  });
  return contents;
}

TEST(BlockTable, DoesWhatAnOrderedMapDoes) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int32_t> coordinate(-9, 9);
  std::uniform_int_distribution<int> dice(0, 2);
  BlockTable<Owner> table;
  std::map<BlockIndex, int> expected;
  for (int step = 0; step < 20000; ++step) {
    const BlockIndex index{coordinate(random), coordinate(random), coordinate(random)};
    const auto known = expected.find(index);
    ASSERT_EQ(table.Find(index) != nullptr, known != expected.end());
    if (known != expected.end()) {
      ASSERT_EQ(**table.Find(index), known->second);
    }
    if (dice(random) == 0) {
      EXPECT_EQ(table.Erase(index), expected.erase(index) == 1);
    } else {
      Owner& value = table.FindOrCreate(index);
      ASSERT_EQ(value == nullptr, known == expected.end()) << "a new one is empty";
      value = std::make_unique<int>(step);
      expected[index] = step;
    }
    ASSERT_EQ(table.size(), expected.size());
  }
  EXPECT_EQ(Contents(table), expected);
  std::vector<BlockIndex> sorted;
  for (const auto& entry : expected) sorted.push_back(entry.first);
  EXPECT_EQ(table.SortedIndices(), sorted);
}

TEST(BlockTable, AReaderFindsWhatTheTableFinds) {
  std::mt19937 random(8);
  std::uniform_int_distribution<int32_t> coordinate(-9, 9);
  std::uniform_int_distribution<int> step(-1, 1);
  BlockTable<int> table;
  BlockTable<int>::Reader of_empty(table);
  EXPECT_EQ(of_empty.Find({0, 0, 0}), nullptr);
  for (int i = 0; i < 2000; ++i)
    table.FindOrCreate({coordinate(random), coordinate(random), coordinate(random)}) = i;
  BlockTable<int>::Reader reader(table);
  BlockIndex index;
  int found = 0, missing = 0;
  for (int i = 0; i < 20000; ++i) {  // mostly in the cube of the last one
    index = {index.x + step(random), index.y + step(random), index.z + step(random)};
    if (i % 100 == 0) index = {coordinate(random), coordinate(random), coordinate(random)};
    const int* value = reader.Find(index);
    ASSERT_EQ(value, table.Find(index));
    ++(value != nullptr ? found : missing);
  }
  EXPECT_GT(found, 1000);
  EXPECT_GT(missing, 1000);
}

TEST(BlockTable, ReachesTheEndsOfTheGrid) {
  constexpr int32_t kLow = INT32_MIN;
  constexpr int32_t kHigh = INT32_MAX;
  BlockTable<int> table;
  const std::vector<BlockIndex> corners{
      {kLow, kLow, kLow}, {kLow, kHigh, 0}, {-1, 0, -4}, {kHigh, kHigh, kHigh}};
  int value = 0;
  for (const BlockIndex& index : corners) table.FindOrCreate(index) = ++value;
  EXPECT_EQ(table.SortedIndices(), corners);
  for (const BlockIndex& index : corners) EXPECT_EQ(*table.Find(index), 1 + (&index - &corners[0]));
}

TEST(BlockTable, ErasedBlocksGiveTheirMemoryBack) {
  const std::shared_ptr<int> watched = std::make_shared<int>(1);
  BlockTable<std::shared_ptr<int>> sharing;
  for (int32_t i = 0; i < 64; ++i) sharing.FindOrCreate({i, 0, 0}) = watched;
  const size_t full = sharing.bytes();
  for (int32_t i = 0; i < 32; ++i) sharing.Erase({i, 0, 0});
  EXPECT_EQ(watched.use_count(), 33);
  EXPECT_LT(sharing.bytes(), full);
  EXPECT_EQ(sharing.Find({31, 0, 0}), nullptr);
  EXPECT_NE(sharing.Find({32, 0, 0}), nullptr);
  sharing.Clear();
  EXPECT_TRUE(sharing.empty());
  EXPECT_EQ(watched.use_count(), 1);
}

TEST(BlockTable, ReferencesLiveWhileOthersComeAndGo) {
  BlockTable<Owner> table;
  Owner& first = table.FindOrCreate({0, 0, 0});
  first = std::make_unique<int>(42);
  for (int32_t i = 1; i < 5000; ++i) table.FindOrCreate({i, -i, 3 * i}) = std::make_unique<int>(i);
  for (int32_t i = 1; i < 5000; ++i) table.Erase({i, -i, 3 * i});
  EXPECT_EQ(&first, table.Find({0, 0, 0}));
  EXPECT_EQ(*first, 42);
  EXPECT_EQ(table.size(), 1U);
}

}  // namespace
}  // namespace vismap
