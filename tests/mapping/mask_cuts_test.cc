#include "mapping/mask_cuts.h"

#include <gtest/gtest.h>

#include "mapping/integrate.h"
#include "support/plane_frames.h"
#include "support/voxel_reading.h"

namespace vismap {
namespace {

using testing_support::LookAtWall;
using testing_support::VoxelAt;

constexpr ClassId kBook{84};

SemanticMap NewMap() { return SemanticMap({0.02, 4}); }

// A frame in which only a mask separates the left part of the wall from the rest.
SegmentedFrame WithMask() {
  SegmentedFrame frame = LookAtWall(1.5);
  testing_support::SplitAtColumn(60, frame);
  testing_support::Detect(0, 0, kBook, frame);
  return frame;
}

SegmentedFrame WithoutMask() {
  SegmentedFrame frame = LookAtWall(1.5);
  frame.had_detections = true;
  return frame;
}

void Fuse(const SegmentedFrame& frame, int times, const IntegrationOptions& options,
          SemanticMap* map) {
  for (int i = 0; i < times; ++i) {
    const FrameAssociation association = Associate(frame, {map->voxels, map->labels}, {});
    IntegrateFrame(frame, association, options, map);
  }
}

ClassId ClassAt(const SemanticMap& map, const Eigen::Vector3d& point_W) {
  const VoxelIndex voxel = VoxelAt(map.voxels, point_W);
  const Block* block = map.voxels.Find(BlockOf(voxel));
  std::array<LabelVote, kVoteSlots> votes;
  for (int slot = 0; slot < kVoteSlots; ++slot)
    votes[static_cast<size_t>(slot)] = block->surface->Vote(OffsetInBlock(voxel), slot);
  return map.labels.Read(StrongestLabel(votes)).class_id;
}

const Eigen::Vector3d kOnTheLeft{-0.5, 0.1, 1.49}, kOnTheRight{0.3, 0.1, 1.49};

TEST(MaskCuts, WhatOnlyMasksTellApartStaysThoughMostFramesHaveNone) {
  for (const double mask_evidence : {IntegrationOptions{}.mask_evidence, 0.0}) {
    IntegrationOptions options;
    options.mask_evidence = mask_evidence;
    SemanticMap map = NewMap();
    Fuse(WithoutMask(), 20, options, &map);
    Fuse(WithMask(), 15, options, &map);
    Fuse(WithoutMask(), 40, options, &map);
    const bool told_apart = ClassAt(map, kOnTheLeft) != ClassAt(map, kOnTheRight);
    EXPECT_EQ(told_apart, mask_evidence > 0);
    if (told_apart) {
      EXPECT_EQ(ClassAt(map, kOnTheLeft), kBook);
    }
  }
}

TEST(MaskCuts, AFalseMaskOfTwoFramesChangesNothing) {
  SemanticMap map = NewMap();
  Fuse(WithoutMask(), 5, {}, &map);
  Fuse(WithMask(), 2, {}, &map);
  Fuse(WithoutMask(), 5, {}, &map);
  EXPECT_EQ(ClassAt(map, kOnTheLeft), ClassId::kUnknown);
}

TEST(MaskCuts, MasksInFewOfTheFramesWithADetectorAreNotEnough) {
  LabelTable labels;
  labels.GrowLabels(SegmentLabel{2});
  LabelRecord& record = labels.MutableRecord(SegmentLabel{1});
  record.class_evidence[kBook] = 3;
  record.frames_with_detector = 12;
  EXPECT_TRUE(MaskCuts({}, labels, 2).IsKept(SegmentLabel{1}));
  EXPECT_FALSE(MaskCuts({}, labels, 3).IsKept(SegmentLabel{1}));
  EXPECT_FALSE(MaskCuts({}, labels, 0).IsKept(SegmentLabel{1}));
  record.frames_with_detector = 13;
  EXPECT_FALSE(MaskCuts({}, labels, 2).IsKept(SegmentLabel{1}));
}

TEST(MaskCuts, KeepsLabelsThatTheFrameDoesNotShowAndThoseMergedIntoThem) {
  LabelTable labels;
  labels.GrowLabels(SegmentLabel{4});
  for (const uint32_t label : {1u, 2u})
    labels.MutableRecord(static_cast<SegmentLabel>(label)).class_evidence[kBook] = 5;
  ASSERT_EQ(labels.Merge(SegmentLabel{2}, SegmentLabel{3}), SegmentLabel{2});
  FrameAssociation association;
  association.segments.push_back({.label = SegmentLabel{1}});
  const MaskCuts cuts(association, labels, 2);
  EXPECT_FALSE(cuts.IsKept(SegmentLabel{1}));
  EXPECT_TRUE(cuts.IsKept(SegmentLabel{2}));
  EXPECT_TRUE(cuts.IsKept(SegmentLabel{3}));
  EXPECT_FALSE(cuts.IsKept(SegmentLabel{9})) << "new in this frame";
  EXPECT_TRUE(cuts.any_kept());
}

TEST(Associate, ToldFromWhichLabelAMaskCutASegment) {
  SemanticMap map = NewMap();
  Fuse(WithoutMask(), 3, {}, &map);
  FrameAssociation cut = Associate(WithMask(), {map.voxels, map.labels}, {});
  EXPECT_EQ(cut.segments[0].cut_from, SegmentLabel{1});
  EXPECT_EQ(cut.segments[1].cut_from, SegmentLabel::kNone);
  SegmentedFrame unmasked = WithMask();  // a boundary of the geometry, not of a mask
  unmasked.segments[0].detection = DetectionIndex::kNone;
  cut = Associate(unmasked, {map.voxels, map.labels}, {});
  EXPECT_EQ(cut.segments[0].cut_from, SegmentLabel::kNone);
  SegmentedFrame one = WithMask();  // two pieces of one object
  testing_support::Detect(1, 0, kBook, one);
  cut = Associate(one, {map.voxels, map.labels}, {});
  EXPECT_EQ(cut.segments[0].cut_from, SegmentLabel::kNone);
}

}  // namespace
}  // namespace vismap
