#include "mapping/integrate.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "support/plane_frames.h"
#include "support/voxel_reading.h"

namespace vismap {
namespace {

using testing_support::LookAtWall;
using testing_support::ReadVoxel;
using testing_support::VoxelAt;
using testing_support::VoxelCenter;
using testing_support::VoxelReading;

MapDelta Fuse(const SegmentedFrame& frame, SemanticMap& map,
              const IntegrationOptions& options = {}) {
  const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
  return IntegrateFrame(frame, association, options, &map);
}

// Signed distance from the centre of a voxel to the plane z = wall [m], along the ray from the
// origin.
double RayDistance(const Eigen::Vector3d& p, double wall) { return p.norm() * (wall / p.z() - 1); }

TEST(IntegrateFrame, DistancesAreExactAlongTheRays) {
  SemanticMap map({0.02, 4});
  Fuse(LookAtWall(1.5), map);
  int checked = 0;
  for (const BlockIndex index : map.voxels.SortedIndices()) {
    const Block& block = *map.voxels.Find(index);
    if (!block.surface) continue;
    for (int z = 0; z < kBlockSide; ++z) {
      const VoxelIndex voxel{index.x * 8 + 3, index.y * 8 + 5, index.z * 8 + z};
      const auto reading = ReadVoxel(map.voxels, voxel);
      if (!reading || reading->distance > 0.079) continue;
      const Eigen::Vector3d p = VoxelCenter(map.voxels, voxel);
      EXPECT_NEAR(reading->distance, RayDistance(p, 1.5), 0.002) << p.transpose();
      ++checked;
    }
  }
  EXPECT_GT(checked, 500);
}

TEST(IntegrateFrame, SameFrameTwiceKeepsDistanceDoublesWeight) {
  SemanticMap map({0.02, 4});
  Fuse(LookAtWall(1.5), map);
  const VoxelIndex voxel = VoxelAt(map.voxels, {0.11, 0.11, 1.49});
  const VoxelReading once = ReadVoxel(map.voxels, voxel).value();
  Fuse(LookAtWall(1.5), map);
  const VoxelReading twice = ReadVoxel(map.voxels, voxel).value();
  EXPECT_NEAR(twice.distance, once.distance, 1e-5);
  EXPECT_NEAR(twice.weight, 2 * once.weight, 0.02);
  EXPECT_EQ(twice.observations, 2);
}

TEST(IntegrateFrame, SpaceBeforeTheWallIsSeenEmptyAndBehindItUnseen) {
  SemanticMap map({0.02, 4});
  Fuse(LookAtWall(1.5), map);
  Fuse(LookAtWall(1.5), map);
  for (double z = 0.3; z < 1.38; z += 0.05) {
    const auto reading = ReadVoxel(map.voxels, VoxelAt(map.voxels, {0, 0, z}));
    ASSERT_TRUE(reading) << z;
    EXPECT_FLOAT_EQ(reading->distance, 0.08F) << z;
    EXPECT_GE(reading->observations, 2) << z;
  }
  EXPECT_FALSE(ReadVoxel(map.voxels, VoxelAt(map.voxels, {0, 0, 1.62})));
  EXPECT_FALSE(ReadVoxel(map.voxels, VoxelAt(map.voxels, {0, 0, -0.5})));
  EXPECT_FALSE(ReadVoxel(map.voxels, VoxelAt(map.voxels, {2.0, 0, 1.0})));  // out of view
}

TEST(IntegrateFrame, PixelsWithoutDepthSayNothing) {
  SemanticMap map({0.02, 4});
  SegmentedFrame frame = LookAtWall(1.5);
  for (int v = 50; v < 70; ++v) {
    for (int u = 70; u < 90; ++u) frame.frame.depth(v, u) = std::numeric_limits<float>::quiet_NaN();
  }
  Fuse(frame, map);
  EXPECT_FALSE(ReadVoxel(map.voxels, VoxelAt(map.voxels, {0, 0, 1.0})));
  EXPECT_FALSE(ReadVoxel(map.voxels, VoxelAt(map.voxels, {0, 0, 1.5})));
  EXPECT_TRUE(ReadVoxel(map.voxels, VoxelAt(map.voxels, {0.4, 0, 1.0})));
}

TEST(IntegrateFrame, BeyondTheRangeOnlyFreeSpaceIsRecorded) {
  SemanticMap map({0.02, 4});
  IntegrationOptions options;
  options.max_range_m = 1.2;
  options.free_space_range_m = 1.0;
  Fuse(LookAtWall(1.5), map, options);
  EXPECT_TRUE(ReadVoxel(map.voxels, VoxelAt(map.voxels, {0, 0, 0.9})));
  EXPECT_FALSE(ReadVoxel(map.voxels, VoxelAt(map.voxels, {0, 0, 1.1})));
  EXPECT_EQ(MeasureMemory(map.voxels).surface_blocks, 0u);
}

TEST(IntegrateFrame, ASurfaceThatAppearsInFreeSpaceIsKept) {
  SemanticMap map({0.02, 4});
  for (int i = 0; i < 3; ++i) Fuse(LookAtWall(1.5), map);
  for (int i = 0; i < 5; ++i) Fuse(LookAtWall(0.9), map);
  EXPECT_NEAR(ReadVoxel(map.voxels, VoxelAt(map.voxels, {0, 0, 0.89}))->distance, 0.01, 0.021);
  EXPECT_LT(ReadVoxel(map.voxels, VoxelAt(map.voxels, {0, 0, 0.93}))->distance, 0.0);
}

void ExpectThreeVotesNearTheWall(const IntegrationOptions& options) {
  SemanticMap map({0.02, 4});
  for (int i = 0; i < 3; ++i) Fuse(LookAtWall(1.5), map, options);
  const double reach = options.vote_distance_voxels * 0.02 - 1e-4;
  for (const BlockIndex index : map.voxels.SortedIndices()) {
    const Block& block = *map.voxels.Find(index);
    if (!block.surface) continue;
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const LabelVote vote = block.surface->Vote(offset, 0);
      const auto reading = ReadVoxel(map.voxels, block, offset);
      if (reading && std::abs(reading->distance) < reach) {
        EXPECT_EQ(vote.votes, 3);
        EXPECT_EQ(vote.label, SegmentLabel{1});
      } else {
        EXPECT_EQ(vote.votes, 0);
      }
    }
  }
}

TEST(IntegrateFrame, VotesOncePerVoxelAndFrameOnlyNearTheSurface) {
  ExpectThreeVotesNearTheWall({});
  for (const double voxels : {0.5, 1.0, 2.0}) {
    IntegrationOptions options;
    options.vote_distance_voxels = voxels;
    ExpectThreeVotesNearTheWall(options);
  }
}

TEST(IntegrateFrame, GivesTheSameMapForAnyNumberOfThreads) {
  std::string hashes[3];
  const int threads[3] = {1, 2, 4};
  for (int run = 0; run < 3; ++run) {
    const ThreadLimit limit(threads[run]);
    SemanticMap map({0.02, 4});
    for (int i = 0; i < 4; ++i) {
      SegmentedFrame frame = LookAtWall(1.5 + 0.01 * i, {0.05 * i, 0, 0});
      testing_support::SplitAtColumn(60 + 10 * i, frame);
      Fuse(frame, map);
    }
    hashes[run] = HashMap(map);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(IntegrateFrame, PackingBlocksOutOfViewChangesNothing) {
  std::string hashes[2];
  size_t packed[2];
  for (int run = 0; run < 2; ++run) {
    SemanticMap map({0.02, 4});
    IntegrationOptions options;
    options.max_unpacked_blocks = run == 0 ? 1000000 : 0;
    for (int i = 0; i < 40; ++i) {  // away and back
      const double x = 0.2 * std::min(i, 40 - i);
      Fuse(LookAtWall(1.5, {x, 0, 0}), map, options);
    }
    hashes[run] = HashMap(map);
    packed[run] = MeasureMemory(map.voxels).packed_blocks;
  }
  EXPECT_EQ(packed[0], 0u);
  EXPECT_GT(packed[1], 100u);
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(IntegrateFrame, ReportsExactlyTheBlocksThatChanged) {
  SemanticMap map({0.02, 4});
  for (int i = 0; i < 3; ++i) Fuse(LookAtWall(1.5), map);
  const MapDelta delta = Fuse(LookAtWall(1.5), map);
  for (const BlockIndex index : delta.changed_blocks) EXPECT_TRUE(map.voxels.Find(index)->surface);
  EXPECT_EQ(delta.changed_blocks.size(), MeasureMemory(map.voxels).surface_blocks);
  EXPECT_EQ(delta.revision, 4);
}

TEST(Associate, KeepsLabelsWhenTheCameraMoves) {
  SemanticMap map({0.02, 4});
  SegmentedFrame first = LookAtWall(1.5);
  testing_support::SplitAtColumn(80, first);
  Fuse(first, map);
  SegmentedFrame moved = LookAtWall(1.5, {0.1, 0, 0});  // the edge moves by 0.1 m * 130 px / 1.5 m
  testing_support::SplitAtColumn(71, moved);
  const FrameAssociation association = Associate(moved, {map.voxels, map.labels}, {});
  EXPECT_EQ(association.segments[0].label, SegmentLabel{1});
  EXPECT_EQ(association.segments[1].label, SegmentLabel{2});
  EXPECT_EQ(association.next_label, SegmentLabel{3});
}

TEST(Associate, ALabelGoesToAtMostOneSegment) {
  SemanticMap map({0.02, 4});
  Fuse(LookAtWall(1.5), map);
  SegmentedFrame split = LookAtWall(1.5);
  testing_support::SplitAtColumn(50, split);
  const FrameAssociation association = Associate(split, {map.voxels, map.labels}, {});
  EXPECT_EQ(association.segments[0].label, SegmentLabel{2});  // the smaller part gets a new label
  EXPECT_EQ(association.segments[1].label, SegmentLabel{1});
}

TEST(Associate, OrderOfSegmentsDoesNotMatter) {
  SemanticMap map({0.02, 4});
  SegmentedFrame frame = LookAtWall(1.5);
  testing_support::SplitAtColumn(70, frame);
  Fuse(frame, map);
  SegmentedFrame swapped = frame;
  for (SegmentIndex& index : swapped.image.index.pixels()) index = SegmentIndex{1 - Raw(index)};
  std::swap(swapped.segments[0], swapped.segments[1]);
  const FrameAssociation a = Associate(frame, {map.voxels, map.labels}, {});
  const FrameAssociation b = Associate(swapped, {map.voxels, map.labels}, {});
  EXPECT_EQ(a.segments[0].label, b.segments[1].label);
  EXPECT_EQ(a.segments[1].label, b.segments[0].label);
}

TEST(Associate, SegmentsOfOneDetectionShareOneInstanceAndKeepIt) {
  SemanticMap map({0.02, 4});
  for (int i = 0; i < 3; ++i) {
    SegmentedFrame frame = LookAtWall(1.5);
    testing_support::SplitAtColumn(70, frame);
    testing_support::Detect(0, 5, ClassId{62}, frame);
    testing_support::Detect(1, 5, ClassId{62}, frame);
    Fuse(frame, map);
  }
  EXPECT_EQ(map.labels.Read(SegmentLabel{1}).instance, InstanceId{1});
  EXPECT_EQ(map.labels.Read(SegmentLabel{2}).instance, InstanceId{1});
  EXPECT_EQ(map.labels.InstanceClasses().at(InstanceId{1}), ClassId{62});
}

TEST(Associate, TwoDetectionsNeverMapToOneInstance) {
  SemanticMap map({0.02, 4});
  SegmentedFrame frame = LookAtWall(1.5);
  testing_support::SplitAtColumn(70, frame);
  testing_support::Detect(0, 0, ClassId{62}, frame);
  testing_support::Detect(1, 0, ClassId{62}, frame);
  Fuse(frame, map);
  testing_support::Detect(1, 1, ClassId{62}, frame);
  const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
  EXPECT_NE(association.segments[0].instance, association.segments[1].instance);
}

TEST(Associate, AnUnmaskedSegmentBlocksNoInstance) {
  SemanticMap map({0.02, 4});
  SegmentedFrame frame = LookAtWall(1.5);
  testing_support::SplitAtColumn(70, frame);
  testing_support::Detect(0, 0, ClassId{62}, frame);
  testing_support::Detect(1, 0, ClassId{62}, frame);
  Fuse(frame, map);
  frame.segments[0].detection = DetectionIndex::kNone;
  const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
  EXPECT_EQ(association.segments[1].instance, InstanceId{1});
  EXPECT_EQ(association.segments[0].instance, InstanceId::kNone);
}

TEST(MergeLabels, PiecesThatKeepLyingOnOneSegmentBecomeOneAndKeepTheirClass) {
  SemanticMap map({0.02, 4});
  SegmentedFrame split = LookAtWall(1.5);
  testing_support::SplitAtColumn(70, split);
  testing_support::Detect(0, 0, ClassId{62}, split);
  split.segments[0].score = 0.5F;  // with more, the masks would keep both labels
  for (int i = 0; i < 4; ++i)
    Fuse(split, map);  // seen once only, it would be outvoted before it could merge
  int merged = 0;
  for (int i = 0; i < 6; ++i) merged += static_cast<int>(Fuse(LookAtWall(1.5), map).merged.size());
  EXPECT_EQ(merged, 1);
  EXPECT_EQ(map.labels.Canonical(SegmentLabel{2}), SegmentLabel{1});
  EXPECT_EQ(map.labels.Record(SegmentLabel{1}).class_evidence.at(ClassId{62}), 2);
}

TEST(MergeLabels, WhatMasksTellApartStaysApartInFramesWithoutMasks) {
  SemanticMap map({0.02, 4});
  SegmentedFrame split = LookAtWall(1.5);
  testing_support::SplitAtColumn(70, split);
  testing_support::Detect(0, 0, ClassId{62}, split);
  for (int i = 0; i < 4; ++i) Fuse(split, map);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(Fuse(LookAtWall(1.5), map).merged.empty());
}

TEST(MergeLabels, PiecesThatWereMergedEarlySeparateAgainWhenLaterFramesShowThemApart) {
  SemanticMap map({0.02, 4});
  SegmentedFrame split = LookAtWall(1.5);
  testing_support::SplitAtColumn(70, split);
  for (int i = 0; i < 4; ++i) Fuse(split, map);
  for (int i = 0; i < 6; ++i) Fuse(LookAtWall(1.5), map);
  ASSERT_EQ(map.labels.Canonical(SegmentLabel{2}), SegmentLabel{1});
  for (int i = 0; i < 12; ++i) Fuse(split, map);
  // Each side has a label of its own again, which is found in a frame that shows this side alone.
  const FrameAssociation both = Associate(split, {map.voxels, map.labels}, {});
  EXPECT_NE(both.segments[0].label, both.segments[1].label);
  for (int side = 0; side < 2; ++side) {
    SegmentedFrame alone = split;
    for (SegmentIndex& index : alone.image.index.pixels()) {
      if (Raw(index) != side) index = SegmentIndex::kNone;
    }
    const FrameAssociation found = Associate(alone, {map.voxels, map.labels}, {});
    EXPECT_EQ(found.segments[static_cast<size_t>(side)].label,
              both.segments[static_cast<size_t>(side)].label);
  }
  for (int i = 0; i < 2; ++i) Fuse(LookAtWall(1.5), map);
  EXPECT_NE(map.labels.Canonical(both.segments[0].label),
            map.labels.Canonical(both.segments[1].label))
      << "two frames do not undo what twelve have shown";
}

TEST(MergeLabels, SeenApartAsOftenAsTogetherTheyStayApart) {
  SemanticMap map({0.02, 4});
  SegmentedFrame split = LookAtWall(1.5);
  testing_support::SplitAtColumn(70, split);
  Fuse(split, map);
  for (int i = 0; i < 10; ++i) {
    Fuse(LookAtWall(1.5), map);
    Fuse(split, map);
  }
  EXPECT_EQ(map.labels.Canonical(SegmentLabel{2}), SegmentLabel{2});
}

}  // namespace
}  // namespace vismap
