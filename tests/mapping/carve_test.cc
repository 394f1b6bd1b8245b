// Objects that are removed from the scene disappear from the map, and nothing else does.
#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "mapping/clear_depth.h"
#include "mapping/integrate.h"
#include "support/plane_frames.h"
#include "support/voxel_reading.h"

namespace vismap {
namespace {

using testing_support::LookAtWall;
using testing_support::ReadVoxel;
using testing_support::VoxelAt;
using testing_support::VoxelReading;

constexpr double kPlate = 1.0, kWall = 2.0;  // [m]

/// A plate in front of the middle of a wall, as a segment of its own.
SegmentedFrame WithPlate() {
  SegmentedFrame frame = LookAtWall(kWall);
  frame.image.segment_count = 2;
  frame.segments.assign(2, FrameSegment{});
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      const bool plate = u >= 40 && u < 120 && v >= 30 && v < 90;
      if (plate) frame.frame.depth(v, u) = static_cast<float>(kPlate);
      frame.image.index(v, u) = plate ? SegmentIndex{1} : SegmentIndex{0};
      ++frame.segments[plate ? 1 : 0].pixels;
    }
  }
  return frame;
}

struct World {
  SemanticMap map{{0.02, 4}};
  IntegrationOptions options;
  int64_t utime = 0;

  MapDelta See(SegmentedFrame frame) {
    frame.frame.header.utime = ++utime;
    return IntegrateFrame(frame, Associate(frame, {map.voxels, map.labels}, {}), options, &map);
  }
  void SeeOften(const SegmentedFrame& frame, int times) {
    for (int i = 0; i < times; ++i) See(frame);
  }
  /// The voxel just behind the front of the plate.
  VoxelReading AtPlate(double u = 80, double v = 60) const {
    const Eigen::Vector3d p = testing_support::SmallCamera().BackProject(u, v, kPlate + 0.01);
    return ReadVoxel(map.voxels, VoxelAt(map.voxels, p)).value();
  }
  /// Number of frames without the plate until no voxel inside it is left; -1 = more than 100.
  int FramesUntilGone() {
    for (int frames = 1; frames <= 100; ++frames) {
      See(LookAtWall(kWall));
      if (Inside() == 0) return frames;
    }
    return -1;
  }
  /// Number of voxels inside the plate that the map holds.
  int Inside() const {
    int inside = 0;
    for (const BlockIndex index : map.voxels.SortedIndices()) {
      const Block& block = *map.voxels.Find(index);
      for (int i = 0; block.surface && i < kBlockVoxels; ++i) {
        const auto reading = ReadVoxel(map.voxels, block, i);
        const int z = index.z * kBlockSide + i / (kBlockSide * kBlockSide);
        if (reading && reading->distance <= 0 && (z + 0.5) * 0.02 < 1.5) ++inside;
      }
    }
    return inside;
  }
};

TEST(Carving, WhatWasRemovedIsGoneAfterAFewFramesHoweverLongItStood) {
  for (const int stood : {5, 30, 300, 1000}) {
    World world;
    world.SeeOften(WithPlate(), stood);
    ASSERT_GT(world.Inside(), 100);
    const int frames = world.FramesUntilGone();
    RecordProperty("frames_after_" + std::to_string(stood), frames);
    std::printf("after %4d frames: gone in %d\n", stood, frames);
    EXPECT_GT(frames, 1);
    EXPECT_LE(frames, 9) << stood;
  }
}

TEST(Carving, WhatComesBackAppearsAfterAFewFramesHoweverLongItWasAway) {
  for (const int away : {10, 300}) {
    World world;
    world.SeeOften(WithPlate(), 30);
    const int whole = world.Inside();
    world.SeeOften(LookAtWall(kWall), away);
    ASSERT_EQ(world.Inside(), 0);
    int frames = 0;
    while (world.Inside() < 0.9 * whole && frames < 100) {
      world.See(WithPlate());
      ++frames;
    }
    std::printf("away for %3d frames: back in %d\n", away, frames);
    EXPECT_LE(frames, 25) << away;
  }
}

TEST(Carving, WithoutItAGhostStays) {
  World world;
  world.options.carve_frames = 0;
  world.SeeOften(WithPlate(), 300);
  EXPECT_EQ(world.FramesUntilGone(), -1);
}

TEST(Carving, AWrongFrameMovesNoSurfaceAndIsForgotten) {
  World world;
  world.SeeOften(WithPlate(), 30);
  const VoxelReading before = world.AtPlate();
  world.See(LookAtWall(kWall));
  const VoxelReading after = world.AtPlate();
  EXPECT_EQ(after.distance, before.distance);
  EXPECT_NEAR(after.weight, before.weight * world.options.carve_keep, 0.02);
  world.SeeOften(WithPlate(), 30);
  EXPECT_NEAR(world.AtPlate().distance, before.distance, 1e-5);
  EXPECT_GT(world.AtPlate().weight, before.weight);
}

TEST(Carving, WhatTheMapHasFreeIsNotTouched) {
  World plain, carved;
  plain.options.carve_frames = 0;
  plain.SeeOften(WithPlate(), 40);
  carved.SeeOften(WithPlate(), 40);
  EXPECT_EQ(HashMap(plain.map), HashMap(carved.map));
}

TEST(Carving, DepthThatIsHardlyFartherIsNoEvidence) {
  World world;
  world.SeeOften(LookAtWall(kPlate), 30);
  const VoxelReading before = world.AtPlate();
  world.SeeOften(LookAtWall(kPlate + 0.07), 3);  // less than the margin of four voxels
  EXPECT_LT(world.AtPlate().distance, before.distance + 0.012);
}

TEST(Carving, ThinThingsAreNotEatenByAnErrorOfThePose) {
  SegmentedFrame pole = LookAtWall(kWall);
  for (int v = 0; v < 120; ++v) {
    for (int u = 79; u < 82; ++u) pole.frame.depth(v, u) = static_cast<float>(kPlate);
  }
  World world;
  world.SeeOften(pole, 30);
  SegmentedFrame off = pole;  // two pixels to the side
  off.frame.header.T_W_C.translation().x() = 2 * kPlate / 130;
  const int before = world.Inside();
  world.SeeOften(off, 10);
  EXPECT_GE(world.Inside(), before);
}

TEST(Carving, NothingIsCutWhereSomePixelsHaveNoReturn) {
  World world;
  world.SeeOften(WithPlate(), 30);
  SegmentedFrame holes = LookAtWall(kWall);
  for (int v = 0; v < 120; v += 4) {
    for (int u = 0; u < 160; u += 4) holes.frame.depth(v, u) = std::nanf("");
  }
  const float before = world.AtPlate(81, 61).weight;
  world.See(holes);
  EXPECT_GE(world.AtPlate(81, 61).weight, before);
}

TEST(Carving, TheLabelKnowsThatItWasClearedUntilItIsSeenAgain) {
  World world;
  world.SeeOften(WithPlate(), 30);
  const FrameAssociation seen = Associate(WithPlate(), {world.map.voxels, world.map.labels}, {});
  const SegmentLabel plate = seen.segments[1].label;
  EXPECT_EQ(world.map.labels.Record(plate).cleared_voxels, 0u);
  world.SeeOften(LookAtWall(kWall), 10);
  const LabelRecord gone = world.map.labels.Record(plate);
  EXPECT_GT(gone.cleared_voxels, 500u);
  EXPECT_GT(gone.cleared_utime, 30);
  EXPECT_EQ(gone.last_utime, 30);
  for (const SegmentLabel label : world.map.labels.Alive()) {
    EXPECT_EQ(world.map.labels.Record(label).cleared_voxels > 0, label == plate);
  }
}

TEST(Carving, SameForAnyNumberOfThreads) {
  const auto hash = [](int threads) {
    const ThreadLimit limit(threads);
    World world;
    world.SeeOften(WithPlate(), 12);
    world.SeeOften(LookAtWall(kWall), 3);
    return HashMap(world.map);
  };
  EXPECT_EQ(hash(1), hash(4));
}

TEST(ClearDepth, IsTheNearestDepthAroundLessTheMargin) {
  const SegmentedFrame frame = WithPlate();
  const Image<float> clear = ClearDepth(DepthPyramid(frame.frame.depth), 160, 120, {0.04F, 0});
  EXPECT_FLOAT_EQ(clear(5, 5), static_cast<float>(kWall) - 0.04F);
  EXPECT_FLOAT_EQ(clear(60, 80), static_cast<float>(kPlate) - 0.04F);
  EXPECT_FLOAT_EQ(clear(60, 38), static_cast<float>(kPlate) - 0.04F);  // beside the plate
}

}  // namespace
}  // namespace vismap
