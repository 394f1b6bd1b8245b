// The fast integration makes the same map as the naive one, and finds all blocks that a frame
// changes.
#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/integrate.h"
#include "mapping/visible_blocks.h"
#include "segmentation/segment_frame.h"
#include "support/naive/associate.h"
#include "support/naive/integrate.h"
#include "support/plane_frames.h"
#include "support/random_detections.h"

namespace vismap {
namespace {

using testing_support::RandomNumbers;

SegmentedFrame RandomSegmentedFrame(const PinholeCamera& camera, RandomNumbers* random) {
  SegmentationStageOptions options;
  options.segmentation.min_segment_px = 5000;  // scaled to the image's size: about 60 pixels
  const DetectionSet detections = testing_support::RandomDetections(camera, random);
  const bool looked = random->Chance(0.7);
  return SegmentFrame(testing_support::RandomFrame(camera, random), looked ? &detections : nullptr,
                      options);
}

IntegrationOptions RandomOptions(RandomNumbers* random) {
  IntegrationOptions options;
  options.min_range_m = random->Real(0.1, 0.6);
  options.max_range_m = random->Real(1, 5);
  options.free_space_range_m = random->Real(0, 5);
  options.free_space = random->Chance(0.7);
  options.max_weight = random->Real(1, 20);
  options.vote_distance_voxels = random->Real(0.5, 3);
  options.merge_frames = random->Whole(0, 3);
  options.carve_frames = random->Real(0, 3);
  options.free_frames = random->Chance(0.3) ? 0 : random->Real(0.5, 5);
  options.carve_keep = random->Real(0.1, 0.9);
  options.carve_margin_voxels = random->Real(2, 8);
  options.carve_slope = random->Real(0, 8);
  options.smooth_radius_px = random->Whole(0, 8);
  if (random->Chance(0.3)) options.noise = RealSenseNoise();
  return options;
}

void ExpectSameDelta(const MapDelta& fast, const MapDelta& slow) {
  EXPECT_EQ(fast.changed_blocks, slow.changed_blocks);
  EXPECT_EQ(fast.merged, slow.merged);
  EXPECT_EQ(fast.voxels_updated, slow.voxels_updated);
  EXPECT_EQ(fast.votes_evicted, slow.votes_evicted);
  EXPECT_EQ(fast.cleared, slow.cleared);
  EXPECT_EQ(fast.revision, slow.revision);
}

void ExpectSameAssociation(const FrameAssociation& fast, const FrameAssociation& slow) {
  ASSERT_EQ(fast.segments.size(), slow.segments.size());
  for (size_t s = 0; s < fast.segments.size(); ++s) {
    EXPECT_EQ(fast.segments[s].label, slow.segments[s].label);
    EXPECT_EQ(fast.segments[s].instance, slow.segments[s].instance);
    EXPECT_EQ(fast.segments[s].cut_from, slow.segments[s].cut_from);
  }
  EXPECT_EQ(fast.together, slow.together);
  EXPECT_EQ(fast.apart, slow.apart);
  EXPECT_EQ(fast.next_label, slow.next_label);
  EXPECT_EQ(fast.next_instance, slow.next_instance);
}

/// Maps some random frames twice.
void Compare(int width, int height, IntegrationOptions options, uint64_t seed) {
  options.keep_thin = false;  // has no twin, and adds changed blocks; see KeepThin
  SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height) + ", seed " +
               std::to_string(seed));
  RandomNumbers random(seed);
  const PinholeCamera camera = testing_support::RandomCamera(width, height, &random);
  const VoxelGridOptions grid{random.Real(0.06, 0.12), 4};
  SemanticMap fast(grid), slow(grid);
  for (int i = 0; i < 4; ++i) {
    const SegmentedFrame frame = RandomSegmentedFrame(camera, &random);
    const FrameAssociation association = Associate(frame, {fast.voxels, fast.labels}, {});
    ExpectSameAssociation(association, naive::Associate(frame, {slow.voxels, slow.labels}, {}));
    ExpectSameDelta(IntegrateFrame(frame, association, options, &fast),
                    naive::IntegrateFrame(frame, association, options, &slow));
    ASSERT_EQ(HashMap(fast), HashMap(slow)) << "frame " << i;
  }
}

TEST(IntegrateFrame, EqualsTheNaiveOneOnRandomScenesOfOddSizes) {
  for (const auto& [width, height] : testing_support::kOddSizes) {
    for (uint64_t seed = 1; seed <= 2; ++seed) Compare(width, height, {}, seed);
  }
}

TEST(IntegrateFrame, EqualsTheNaiveOneWithOtherOptions) {
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    RandomNumbers random(seed + 1000);
    Compare(97, 73, RandomOptions(&random), seed);
  }
}

TEST(IntegrateFrame, EqualsTheNaiveOneWhenVotesHalveAndAreEvicted) {
  RandomNumbers random(5);
  const PinholeCamera camera = testing_support::RandomCamera(40, 30, &random);
  const SegmentedFrame frame = RandomSegmentedFrame(camera, &random);
  IntegrationOptions options;
  options.keep_thin = false;
  options.max_range_m = options.free_space_range_m = 1;
  SemanticMap fast({0.1, 4}), slow({0.1, 4});
  int64_t evicted = 0;
  for (int i = 0; i < 320; ++i) {
    FrameAssociation association;  // 260 times the same label, then any of five
    const auto shift = static_cast<uint32_t>(i < 260 ? 0 : random.Whole(0, 4));
    for (uint32_t s = 0; s < frame.segments.size(); ++s)
      association.segments.push_back({SegmentLabel{1 + s + shift}, InstanceId::kNone});
    association.next_label = SegmentLabel{1000};
    const MapDelta delta = IntegrateFrame(frame, association, options, &fast);
    evicted += delta.votes_evicted;
    ExpectSameDelta(delta, naive::IntegrateFrame(frame, association, options, &slow));
  }
  EXPECT_EQ(HashMap(fast), HashMap(slow));
  EXPECT_GT(evicted, 0);
}

/// Whether the visibility that FindVisibleBlocks states for a block is true for its voxels;
/// kNothing stands for a block that it does not list.
bool IsTrue(BlockVisibility view, const naive::BlockSaid& said) {
  switch (view) {
    case BlockVisibility::kNothing:
      return said.near + said.free == 0;
    case BlockVisibility::kMixed:
      return true;
    case BlockVisibility::kPartlyFree:
      return said.near == 0;
    case BlockVisibility::kWhollyFree:
      return said.free == kBlockVoxels;
  }
  return false;
}

TEST(FindVisibleBlocks, FindsAllBlocksThatBruteForceFindsAndSaysNothingFalse) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    RandomNumbers random(seed);
    const PinholeCamera camera = testing_support::RandomCamera(97, 73, &random);
    const SegmentedFrame frame = RandomSegmentedFrame(camera, &random);
    const VoxelMap map({random.Real(0.03, 0.08), 4});
    IntegrationOptions options = RandomOptions(&random);
    options.smooth_radius_px = 0;  // the pyramid is that of the depth as measured
    const std::vector<VisibleBlock> visible =
        FindVisibleBlocks(frame.frame.header, DepthPyramid(frame.frame.depth),
                          {map.block_size(), map.truncation(), options.min_range_m,
                           options.max_range_m, options.free_space_range_m, options.free_space});
    const auto before = [](const VisibleBlock& a, BlockIndex b) { return a.index < b; };
    for (const BlockIndex index : naive::BlocksInView(frame.frame.header, options, map)) {
      const auto found = std::lower_bound(visible.begin(), visible.end(), index, before);
      const bool is_listed = found != visible.end() && found->index == index;
      const BlockVisibility view = is_listed ? found->view : BlockVisibility::kNothing;
      EXPECT_TRUE(IsTrue(view, naive::WhatIsSaid(frame, options, map.options(), index)))
          << index.x << " " << index.y << " " << index.z << ": " << static_cast<int>(view);
    }
  }
}

TEST(FindVisibleBlocks, FewOfThemSayNothing) {
  // Of the many blocks at the sides of the view, those outside of it must not be listed.
  SegmentedFrame frame = testing_support::LookAtWall(2.5);
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -1).normalized();
  frame.frame.header.T_W_C.linear() = Eigen::AngleAxisd(0.7, axis).toRotationMatrix();
  const VoxelMap map({0.02, 4});
  const IntegrationOptions options;
  const std::vector<VisibleBlock> visible =
      FindVisibleBlocks(frame.frame.header, DepthPyramid(frame.frame.depth),
                        {map.block_size(), map.truncation(), options.min_range_m,
                         options.max_range_m, options.free_space_range_m, options.free_space});
  const auto silent = std::count_if(visible.begin(), visible.end(), [&](const VisibleBlock& block) {
    const naive::BlockSaid said = naive::WhatIsSaid(frame, options, map.options(), block.index);
    return said.near + said.free == 0;
  });
  ASSERT_GT(visible.size(), 500u);
  EXPECT_LT(static_cast<double>(silent), 0.05 * static_cast<double>(visible.size()));
}

}  // namespace
}  // namespace vismap
