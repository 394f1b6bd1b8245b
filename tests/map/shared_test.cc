#include "map/shared.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

#include "map/block_table.h"
#include "map/surface_reader.h"

namespace vismap {
namespace {

TEST(Shared, CopiesShareAValueUntilOneChangesIt) {
  auto first = Shared<std::vector<int>>::Make(3, 7);
  const Shared<std::vector<int>> second = first;
  EXPECT_EQ(std::as_const(first).get(), second.get());
  first->push_back(1);
  EXPECT_EQ(second->size(), 3u);
  EXPECT_EQ(first->size(), 4u);
  const std::vector<int>* alone = first.get();
  first->push_back(2);
  EXPECT_EQ(first.get(), alone) << "a value with one user is not copied";
}

TEST(Shared, HoldsNothingAfterAMoveOrReset) {
  Shared<int> a(std::make_unique<int>(5));
  Shared<int> b = std::move(a);
  EXPECT_EQ(*std::as_const(b), 5);
  EXPECT_TRUE(a == nullptr);  // NOLINT: what a move leaves is the subject
  b.reset();
  EXPECT_FALSE(b);
  EXPECT_EQ(b.get(), nullptr);
  EXPECT_FALSE(Shared<int>(std::unique_ptr<int>()));
}

TEST(Shared, ThreadsMayChangeTheirOwnCopies) {
  constexpr int kRounds = 2000;
  auto value = Shared<std::array<int, 16>>::Make();
  for (int round = 0; round < kRounds; ++round) {
    const Shared<std::array<int, 16>> copy = value;
    std::thread reader([copy, round] {
      for (const int number : *copy) EXPECT_EQ(number, round);
    });
    for (int& number : *value) ++number;
    reader.join();
  }
  EXPECT_EQ((*std::as_const(value))[15], kRounds);
}

TEST(Shared, CopiesOfBlocksStayAsTheyWereWhileTheOriginalChanges) {
  BlockTable<Block> table;
  for (int32_t i = 0; i < 100; ++i) {
    Block& block = table.FindOrCreate({i, -i, i / 3});
    if (i % 3 == 0) block.surface = Shared<SurfaceVoxels>::Make();
    if (i % 3 == 1) block.free = Shared<FreeVoxels>::Make();
    if (i % 4 == 0) block.thin = Shared<ThinVoxels>::Make();
    if (i % 3 == 0) block.surface->distance[5] = static_cast<int16_t>(i);
    if (i % 6 == 0) block.surface.Pack();
  }
  const BlockTable<Block> copy = table;
  for (int32_t i = 0; i < 100; ++i) {
    Block& block = *table.Find({i, -i, i / 3});
    block.surface.Unpack();
    if (block.surface) block.surface->distance[5] = -1;
    if (block.surface && i % 2 == 0) block.surface.Pack();
    if (block.free) block.free->once[0] = 9;
    if (block.thin) block.thin->hits[3] = 4;
    if (i % 5 == 0) table.Erase({i, -i, i / 3});
  }
  EXPECT_EQ(copy.size(), 100u);
  EXPECT_EQ(table.size(), 80u);
  for (int32_t i = 0; i < 100; ++i) {
    const Block* block = copy.Find({i, -i, i / 3});
    ASSERT_NE(block, nullptr);
    SurfaceReader reader;
    const SurfaceVoxels* voxels = reader.Read(*block);
    ASSERT_EQ(voxels != nullptr, i % 3 == 0);
    if (voxels != nullptr) {
      EXPECT_EQ(voxels->distance[5], i);
    }
    if (block->free) {
      EXPECT_EQ(block->free->once[0], 0u);
    }
    if (block->thin) {
      EXPECT_EQ(block->thin->hits[3], 0);
    }
  }
}

}  // namespace
}  // namespace vismap
