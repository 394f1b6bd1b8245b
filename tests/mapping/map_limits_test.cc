#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "base/parallel.h"
#include "mapping/integrate.h"
#include "support/mutations.h"
#include "support/plane_frames.h"

// What one frame, and many of them, can do to the memory of a map.

namespace vismap {
namespace {

using ::testing::HasSubstr;
using testing_support::LookAtWall;

constexpr size_t kMegabyte = size_t{1} << 20;

MapDelta Fuse(const SegmentedFrame& frame, const IntegrationOptions& options, SemanticMap* map) {
  const FrameAssociation association = Associate(frame, {map->voxels, map->labels}, {});
  return IntegrateFrame(frame, association, options, map);
}

/// A frame with a random depth in every pixel: a surface may pass near every block in view.
SegmentedFrame Noise(uint64_t seed, const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) {
  SegmentedFrame frame = LookAtWall(position.z() + 1, position);
  TestRandom random(seed);
  for (float& depth : frame.frame.depth.pixels())
    depth = static_cast<float>(0.2 + 4.7 * random.Unit());
  return frame;
}

TEST(MapLimits, AFrameThatWouldChangeTooManyBlocksIsRefusedAndChangesNothing) {
  SemanticMap map({0.02, 4});
  IntegrationOptions options;
  Fuse(LookAtWall(1.5), options, &map);
  const std::string hash = HashMap(map);
  options.max_frame_blocks = 1000;
  const MapDelta delta = Fuse(Noise(1), options, &map);
  EXPECT_THAT(delta.refused, HasSubstr("more than 1000 blocks"));
  EXPECT_EQ(delta.revision, 1);
  EXPECT_EQ(HashMap(map), hash);
  EXPECT_TRUE(delta.changed_blocks.empty());
  EXPECT_EQ(Fuse(LookAtWall(1.5), options, &map).refused, "") << "an ordinary frame";
  EXPECT_NE(HashMap(map), hash);
}

/// A wall of small square segments, all of them under one mask.
SegmentedFrame ManySegments(int side) {
  SegmentedFrame frame = LookAtWall(1.5);
  const int columns = frame.image.index.width() / side, rows = frame.image.index.height() / side;
  frame.image.segment_count = columns * rows;
  frame.segments.assign(static_cast<size_t>(columns * rows), FrameSegment{});
  for (int v = 0; v < rows * side; ++v) {
    for (int u = 0; u < columns * side; ++u) {
      const int segment = v / side * columns + u / side;
      frame.image.index(v, u) = static_cast<SegmentIndex>(segment);
      testing_support::Detect(segment, 0, ClassId{62}, frame);
      ++frame.segments[static_cast<size_t>(segment)].pixels;
    }
  }
  return frame;
}

TEST(MapLimits, AFrameOfVeryManySegmentsUnderMasksIsRefused) {
  for (const bool many : {false, true}) {
    SemanticMap map({0.01, 4});
    const SegmentedFrame frame = ManySegments(many ? 4 : 8);
    const FrameAssociation association =
        Associate(frame, {map.voxels, map.labels}, {.min_overlap_points = 5});
    const MapDelta delta = IntegrateFrame(frame, association, {}, &map);
    EXPECT_EQ(map.revision, many ? 0 : 1);
    EXPECT_EQ(map.labels.bonds().pairs().size(), many ? 0u : 300u * 299 / 2);
    EXPECT_EQ(delta.refused,
              many ? "the frame has 1200 segments under masks; at most 1000 can be mapped" : "");
  }
}

TEST(MapLimits, WhatAFrameWouldChangeIsFoundInBoundedTimeAndMemory) {
  SegmentedFrame frame = Noise(1);
  frame.frame.header.camera.fx = frame.frame.header.camera.fy = 22;  // the widest view allowed
  IntegrationOptions options;
  options.max_range_m = options.free_space_range_m = 200;
  for (float& depth : frame.frame.depth.pixels()) depth *= 40;
  SemanticMap map({0.001, 4});
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(Fuse(frame, options, &map).refused, HasSubstr("max_frame_blocks"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
  EXPECT_EQ(map.voxels.size(), 0u);
}

TEST(MapLimits, AMapThatHasReachedItsLimitIsUpdatedButDoesNotGrow) {
  SemanticMap map({0.01, 4});
  IntegrationOptions options;
  options.max_map_mb = 64;
  options.max_unpacked_blocks = 100;
  ASSERT_EQ(Fuse(LookAtWall(1.5), options, &map).refused, "");
  int64_t left_out = 0;
  int refused = 0;
  for (int i = 1; i <= 60; ++i) {  // a pose that runs away
    const MapDelta delta = Fuse(LookAtWall(1.5 + 10 * i, {0, 0, 10.0 * i}), options, &map);
    left_out += delta.blocks_left_out;
    refused += !delta.refused.empty();
    if (!delta.refused.empty()) {
      EXPECT_THAT(delta.refused, HasSubstr("limit of 64 MB"));
    }
    ASSERT_LE(BytesOf(map), 64 * kMegabyte);
  }
  EXPECT_GT(refused, 10);
  EXPECT_GT(left_out, 1000);
  const MapDelta again = Fuse(LookAtWall(1.5), options, &map);
  EXPECT_EQ(again.refused, "") << "the map has this surface";
  EXPECT_GT(again.changed_blocks.size(), 100u);
  EXPECT_LE(BytesOf(map), 70 * kMegabyte) << "blocks in view are unpacked";
}

TEST(MapLimits, TheCountedMemoryIsThatOfTheBlocks) {
  SemanticMap map({0.01, 4});
  IntegrationOptions options;
  options.max_unpacked_blocks = 300;
  for (int i = 0; i < 30; ++i) {
    Fuse(LookAtWall(1.5, {0.2 * i, 0, 0}), options, &map);
    const auto measured = static_cast<double>(MeasureMemory(map.voxels).total_bytes());
    EXPECT_NEAR(static_cast<double>(map.voxels.bytes()) / measured, 1, 0.05);
  }
  EXPECT_GT(MeasureMemory(map.voxels).packed_blocks, 500u);
}

TEST(MapLimits, DoNotDependOnThreads) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    SemanticMap map({0.01, 4});
    IntegrationOptions options;
    options.max_map_mb = 48;
    options.max_unpacked_blocks = 100;
    options.max_frame_blocks = 5000;
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d position(0, 0, 0.5 * i);
      Fuse(i % 5 == 4 ? Noise(static_cast<uint64_t>(i), position)
                      : LookAtWall(1.5 + position.z(), position),
           options, &map);
    }
    EXPECT_LT(map.revision, 20);
    hashes.push_back(HashMap(map));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

}  // namespace
}  // namespace vismap
