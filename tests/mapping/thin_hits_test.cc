// Things that are thinner than voxels are not free, since rays pass beside them.
#include "mapping/thin_hits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mapping/integrate.h"
#include "support/plane_frames.h"

namespace vismap {
namespace {

using testing_support::LookAtWall;
using testing_support::SmallCamera;

constexpr double kThinWall = 2.0, kThinPost = 1.2;  // [m]

/// A wall with a post of `width` pixels before it, in columns [80, 80 + width) and rows [20, 100).
SegmentedFrame WithPost(int width, const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) {
  SegmentedFrame frame = LookAtWall(kThinWall, position);
  for (int v = 20; v < 100; ++v) {
    for (int u = 80; u < 80 + width; ++u) frame.frame.depth(v, u) = static_cast<float>(kThinPost);
  }
  return frame;
}

std::vector<ThinHit> HitsOf(const SegmentedFrame& frame) {
  ThinOptions options;
  options.voxel_size = 0.02;
  return FindThinHits(frame.frame.header, frame.frame.depth, options);
}

TEST(ThinHits, AreTheVoxelsInWhichDepthOfAPostEnds) {
  const SegmentedFrame frame = WithPost(2);  // 1.8 cm
  const std::vector<ThinHit> hits = HitsOf(frame);
  ASSERT_GT(hits.size(), 30u);
  for (const ThinHit& hit : hits) {
    const int z = hit.block.z * kBlockSide + hit.voxel / (kBlockSide * kBlockSide);
    EXPECT_EQ(z, 60);  // 1.2 m / 2 cm
  }
  EXPECT_TRUE(std::is_sorted(hits.begin(), hits.end()));
}

TEST(ThinHits, ARodAcrossIsFoundAsWell) {
  SegmentedFrame frame = LookAtWall(kThinWall);
  for (int v = 60; v < 62; ++v) {
    for (int u = 20; u < 140; ++u) frame.frame.depth(v, u) = static_cast<float>(kThinPost);
  }
  EXPECT_GT(HitsOf(frame).size(), 40u);
}

TEST(ThinHits, NothingIsThinOnAWallAnEdgeOrAWideThing) {
  EXPECT_TRUE(HitsOf(LookAtWall(kThinWall)).empty());
  EXPECT_TRUE(HitsOf(WithPost(5)).empty()) << "4.6 cm";
  SegmentedFrame edge = LookAtWall(kThinWall);
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 80; ++u) edge.frame.depth(v, u) = static_cast<float>(kThinPost);
  }
  EXPECT_TRUE(HitsOf(edge).empty());
}

TEST(ThinHits, PixelsWithoutReturnBesideItDoNotHideIt) {
  SegmentedFrame frame = WithPost(2);
  const size_t whole = HitsOf(frame).size();
  for (int v = 0; v < 120; ++v) {
    for (const int u : {78, 79, 82, 83}) frame.frame.depth(v, u) = std::nanf("");
  }
  EXPECT_EQ(HitsOf(frame).size(), whole);
}

TEST(ThinHits, WhatIsTooFarForTheNoiseIsLeftOut) {
  SegmentedFrame frame = LookAtWall(6);
  for (int v = 20; v < 100; ++v) frame.frame.depth(v, 80) = 4.5F;
  EXPECT_TRUE(HitsOf(frame).empty());
}

TEST(ThinHits, DoNotDependOnTheNumberOfThreads) {
  const SegmentedFrame frame = WithPost(2);
  const ThreadLimit one(1);
  const std::vector<ThinHit> alone = HitsOf(frame);
  const ThreadLimit four(4);
  EXPECT_EQ(HitsOf(frame), alone);
}

/// A map of 2 cm that looks at the post from several places, so that few rays through the centres
/// of voxels end on it.
struct ThinWorld {
  SemanticMap map = SemanticMap(VoxelGridOptions{0.02, 4});
  IntegrationOptions options;
  int64_t utime = 0;

  MapDelta See(SegmentedFrame frame) {
    frame.frame.header.utime = ++utime;
    return IntegrateFrame(frame, Associate(frame, {map.voxels, map.labels}, {}), options, &map);
  }
  /// Voxels with at least three hits.
  int64_t Hits() const {
    int64_t hits = 0;
    map.voxels.blocks().ForEach([&](BlockIndex, const Block& block) {
      if (!block.thin) return;
      hits += std::count_if(block.thin->hits.begin(), block.thin->hits.end(),
                            [](uint8_t count) { return count >= 3; });
    });
    return hits;
  }
};

TEST(KeepThin, HitsAreKeptUntilTheCameraSeesPastThem) {
  ThinWorld world;
  for (int i = 0; i < 20; ++i) world.See(WithPost(2));
  EXPECT_GT(world.Hits(), 30);
  for (int i = 0; i < 3; ++i) world.See(LookAtWall(kThinWall));
  EXPECT_EQ(world.Hits(), 0) << "twelve, six, three, one";
  for (int i = 0; i < 3; ++i) world.See(LookAtWall(kThinWall));
  world.map.voxels.blocks().ForEach(
      [](BlockIndex, const Block& block) { EXPECT_EQ(block.thin, nullptr); });
}

TEST(KeepThin, DoesNotChangeTheHashAndChangesNoBlockThatIsNotListed) {
  ThinWorld with, without;
  without.options.keep_thin = false;
  for (int i = 0; i < 4; ++i) {
    const MapDelta delta = with.See(WithPost(2));
    without.See(WithPost(2));
    with.map.voxels.blocks().ForEach([&](BlockIndex index, const Block& block) {
      if (!block.thin) return;
      EXPECT_TRUE(
          std::binary_search(delta.changed_blocks.begin(), delta.changed_blocks.end(), index));
    });
  }
  EXPECT_GT(with.Hits(), 0);
  EXPECT_EQ(without.Hits(), 0);
  EXPECT_EQ(HashMap(with.map), HashMap(without.map));
}

}  // namespace
}  // namespace vismap
