// The fast association equals the naive one on random maps and frames.
#include <gtest/gtest.h>

#include "association/associate.h"
#include "support/add_vote.h"
#include "support/naive/associate.h"
#include "support/naive/voxel_access.h"
#include "support/random_scenes.h"

namespace vismap {
namespace {

using testing_support::AddVote;
using testing_support::RandomNumbers;

SegmentLabel AnyLabel(int labels, RandomNumbers* random) {
  return static_cast<SegmentLabel>(random->Whole(1, labels));
}

/// Voxels of blocks around the origin, with random votes for a few labels each.
VoxelMap RandomVoxels(int labels, RandomNumbers* random) {
  VoxelMap map({0.08, 4});
  for (int i = 0; i < 400; ++i) {
    const BlockIndex index{random->Whole(-3, 3), random->Whole(-3, 3), random->Whole(-1, 5)};
    Block& block = map.FindOrCreate(index);
    if (!block.surface) block.surface = std::make_unique<SurfaceVoxels>();
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      if (random->Chance(0.2)) continue;
      naive::WriteVoxel(*block.surface, offset,
                        {static_cast<int16_t>(random->Whole(-20000, 20000)),
                         static_cast<uint16_t>(random->Whole(0, 3)),
                         1,
                         {}});
      for (int votes = random->Whole(0, 9); votes > 0; --votes)
        AddVote(*block.surface, offset, AnyLabel(labels, random));
    }
  }
  return map;
}

/// Labels of which some are merged, with evidence for instances and pairs.
LabelTable RandomLabels(int labels, RandomNumbers* random) {
  LabelTable table;
  table.GrowLabels(static_cast<SegmentLabel>(labels + 1));
  table.GrowInstances(InstanceId{6});
  for (int i = 0; i < labels / 3; ++i) {
    const SegmentLabel a = table.Canonical(AnyLabel(labels, random));
    const SegmentLabel b = table.Canonical(AnyLabel(labels, random));
    if (a != b) table.Merge(a, b);
  }
  for (int i = 0; i < 2 * labels; ++i) {
    const SegmentLabel a = table.Canonical(AnyLabel(labels, random));
    const SegmentLabel b = table.Canonical(AnyLabel(labels, random));
    if (a != b) table.MutablePair(a, b).together += 1;
    const auto instance = static_cast<InstanceId>(random->Whole(1, 5));
    table.MutableRecord(a).instance_evidence[instance] += static_cast<float>(random->Whole(0, 3));
  }
  return table;
}

/// A frame of a random scene cut into stripes and patches, some of them detected.
SegmentedFrame RandomStripes(const PinholeCamera& camera, RandomNumbers* random) {
  SegmentedFrame frame;
  frame.frame = testing_support::RandomFrame(camera, random);
  const int count = random->Whole(1, 12), width = random->Whole(1, 40);
  frame.image = {Image<SegmentIndex>(camera.width, camera.height, SegmentIndex::kNone), count};
  frame.segments.resize(static_cast<size_t>(count));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      if (random->Chance(0.1)) continue;
      const int segment = (u / width + 3 * (v / 25)) % count;
      frame.image.index(v, u) = static_cast<SegmentIndex>(segment);
      ++frame.segments[static_cast<size_t>(segment)].pixels;
    }
  }
  for (FrameSegment& segment : frame.segments) {
    if (random->Chance(0.5)) segment.detection = static_cast<DetectionIndex>(random->Whole(0, 3));
  }
  return frame;
}

void ExpectSame(const FrameAssociation& fast, const FrameAssociation& slow) {
  ASSERT_EQ(fast.segments.size(), slow.segments.size());
  for (size_t s = 0; s < fast.segments.size(); ++s) {
    EXPECT_EQ(fast.segments[s].label, slow.segments[s].label) << "segment " << s;
    EXPECT_EQ(fast.segments[s].instance, slow.segments[s].instance) << "segment " << s;
    EXPECT_EQ(fast.segments[s].cut_from, slow.segments[s].cut_from) << "segment " << s;
  }
  EXPECT_EQ(fast.together, slow.together);
  EXPECT_EQ(fast.apart, slow.apart);
  EXPECT_EQ(fast.next_label, slow.next_label);
  EXPECT_EQ(fast.next_instance, slow.next_instance);
}

TEST(Associate, EqualsTheNaiveOneOnRandomMapsAndFrames) {
  size_t matched = 0, together = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    RandomNumbers random(seed);
    const int label_count = random.Whole(2, 40);
    const VoxelMap voxels = RandomVoxels(label_count, &random);
    const LabelTable labels = RandomLabels(label_count, &random);
    const PinholeCamera camera = testing_support::RandomCamera(161, 119, &random);
    const SegmentedFrame frame = RandomStripes(camera, &random);
    AssociationOptions options;
    options.min_overlap_points = random.Whole(0, 60);
    options.pixel_stride = random.Whole(1, 3);
    options.max_distance_voxels = random.Real(0.3, 2.5);
    options.max_range_m = random.Real(1, 6);
    options.merge_overlap_ratio = random.Real(0.01, 0.3);
    const FrameAssociation fast = Associate(frame, {voxels, labels}, options);
    ExpectSame(fast, naive::Associate(frame, {voxels, labels}, options));
    for (const auto& segment : fast.segments)
      matched += segment.label != SegmentLabel::kNone && segment.label < labels.next_label();
    together += fast.together.size();
  }
  EXPECT_GT(matched, 100u);  // the frames show labels of the maps
  EXPECT_GT(together, 100u);
}

TEST(Associate, EqualsTheNaiveOneOnImagesOfOddSizes) {
  for (const auto& [width, height] : testing_support::kOddSizes) {
    RandomNumbers random(static_cast<uint64_t>(width * 1000 + height));
    const VoxelMap voxels = RandomVoxels(9, &random);
    const LabelTable labels = RandomLabels(9, &random);
    const SegmentedFrame frame =
        RandomStripes(testing_support::RandomCamera(width, height, &random), &random);
    ExpectSame(Associate(frame, {voxels, labels}, {}),
               naive::Associate(frame, {voxels, labels}, {}));
  }
}

}  // namespace
}  // namespace vismap
