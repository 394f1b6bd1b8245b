#include <gtest/gtest.h>

#include <random>

#include "map/surface_reader.h"

namespace vismap {
namespace {

/// Random voxels; a share of about `share` of them is not empty.
std::unique_ptr<SurfaceVoxels> RandomVoxels(double share, size_t labels, uint32_t seed) {
  std::mt19937 random(seed);
  auto voxels = std::make_unique<SurfaceVoxels>();
  for (size_t l = 0; l < labels; ++l)
    voxels->palette.push_back(static_cast<SegmentLabel>(random() | 1u));
  const auto byte = [&] { return static_cast<uint8_t>(random()); };
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    if (static_cast<double>(random() % 1000) >= share * 1000) continue;
    voxels->distance[i] = static_cast<int16_t>(random());
    voxels->weight[i] = static_cast<uint16_t>(random());
    voxels->observations[i] = byte();
    voxels->color[i] = {byte(), byte(), byte()};
    for (size_t slot = 0; slot < kVoteSlots && labels > 0; ++slot) {
      voxels->slot_label[i][slot] = static_cast<uint8_t>(random() % (labels + 1));
      voxels->slot_votes[i][slot] = byte();
    }
  }
  return voxels;
}

void ExpectEqual(const SurfaceVoxels& a, const SurfaceVoxels& b) {
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.weight, b.weight);
  EXPECT_EQ(a.observations, b.observations);
  EXPECT_EQ(a.color, b.color);
  EXPECT_EQ(a.slot_label, b.slot_label);
  EXPECT_EQ(a.slot_votes, b.slot_votes);
  EXPECT_EQ(a.palette, b.palette);
}

TEST(SurfaceHolder, PackedVoxelsAreTheSameVoxels) {
  uint32_t seed = 1;
  for (const double share : {0.0, 0.01, 0.5, 1.0}) {
    for (const size_t labels : {size_t{0}, size_t{1}, size_t{7}, size_t{255}}) {
      SCOPED_TRACE(std::to_string(share) + " of the voxels, labels " + std::to_string(labels));
      Block block;
      block.surface = RandomVoxels(share, labels, ++seed);
      const SurfaceVoxels before = *block.surface;
      block.surface.Pack();
      ASSERT_TRUE(block.surface.packed());
      ASSERT_TRUE(static_cast<bool>(block.surface));
      EXPECT_GT(block.surface.packed_bytes(), 0u);
      SurfaceReader reader;
      ExpectEqual(*reader.Read(block), before);
      block.surface.Unpack();
      ASSERT_FALSE(block.surface.packed());
      ExpectEqual(*block.surface, before);
    }
  }
}

TEST(SurfaceHolder, PackingNothingIsNothing) {
  Block block;
  block.surface.Pack();
  block.surface.Unpack();
  EXPECT_FALSE(static_cast<bool>(block.surface));
  EXPECT_EQ(SurfaceReader().Read(block), nullptr);
  EXPECT_ANY_THROW({
    SurfaceVoxels voxels;
    block.surface.CopyTo(&voxels);
  });
}

TEST(SurfaceReader, CopiesLiveUntilTheyAreTrimmed) {
  std::vector<Block> blocks(50);
  for (size_t i = 0; i < blocks.size(); ++i) {
    blocks[i].surface = RandomVoxels(0.5, 3, static_cast<uint32_t>(i));
    blocks[i].surface.Pack();
  }
  SurfaceReader reader;
  std::vector<const SurfaceVoxels*> read;
  for (const Block& block : blocks) read.push_back(reader.Read(block));
  for (size_t i = 0; i < blocks.size(); ++i) {
    EXPECT_EQ(reader.Read(blocks[i]), read[i]);
    ExpectEqual(*read[i], *RandomVoxels(0.5, 3, static_cast<uint32_t>(i)));
  }
  reader.Trim(1);
  EXPECT_EQ(reader.Read(blocks.back()), read.back());
  ExpectEqual(*reader.Read(blocks.front()), *RandomVoxels(0.5, 3, 0));
}

}  // namespace
}  // namespace vismap
