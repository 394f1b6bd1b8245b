#include "meshing/object_tracker.h"

#include <gtest/gtest.h>

#include <map>

#include "support/plane_frames.h"
#include "volume/surface_reader.h"

namespace vismap {
namespace {

using testing::LookAtWall;

/// Blocks where a label has votes, by a look at all of them.
class AllPlaces {
 public:
  explicit AllPlaces(const SemanticMap& map) {
    for (const BlockIndex index : map.voxels.SortedIndices()) {
      SurfaceReader reader;
      const SurfaceVoxels* voxels = reader.Read(*map.voxels.Find(index));
      if (voxels == nullptr) continue;
      for (const SegmentLabel label : voxels->palette)
        places_[map.labels.Canonical(label)].push_back(index);
    }
  }
  std::span<const BlockIndex> operator()(SegmentLabel label) const {
    const auto found = places_.find(label);
    return found == places_.end() ? std::span<const BlockIndex>() : found->second;
  }

 private:
  std::map<SegmentLabel, std::vector<BlockIndex>> places_;
};

void ExpectSame(const std::vector<ObjectSummary>& a, const std::vector<ObjectSummary>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].instance, b[i].instance);
    EXPECT_EQ(a[i].segments, b[i].segments);
    EXPECT_EQ(a[i].class_id, b[i].class_id);
    EXPECT_EQ(a[i].points, b[i].points);
    EXPECT_NEAR(a[i].score, b[i].score, 1e-9);
    EXPECT_NEAR(a[i].area, b[i].area, 1e-9);
    // Boxes are fitted to an even pick of the points of a large label.
    EXPECT_TRUE(a[i].box.size.isApprox(b[i].box.size, a[i].points > 2000 ? 0.02 : 1e-6));
    EXPECT_EQ(a[i].is_structure, b[i].is_structure);
  }
}

TEST(ObjectTracker, FollowsAGrowingMap) {
  SemanticMap map({0.02, 4});
  ObjectTracker tracker;
  const ObjectOptions options;
  for (int i = 0; i < 8; ++i) {
    SegmentedFrame frame = LookAtWall(1.5, {0.1 * i, 0, 0});
    testing::SplitAtColumn(70 - 9 * i, frame);
    testing::Detect(1, 0, ClassId{62}, frame);
    const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
    tracker.NoteChanges(map, IntegrateFrame(frame, association, {}, &map));
    const std::vector<ObjectSummary> objects = tracker.Summarize(map, AllPlaces(map), {}, options);
    ExpectSame(objects, SummarizeObjects(map, options));
  }
}

TEST(ObjectTracker, AMergedLabelIsNotAnObjectOfItsOwn) {
  SemanticMap map({0.02, 4});
  ObjectTracker tracker;
  SegmentedFrame split = LookAtWall(1.5);
  testing::SplitAtColumn(70, split);
  size_t merged = 0;
  for (int i = 0; i < 12; ++i) {
    const SegmentedFrame frame = i < 3 ? split : LookAtWall(1.5);
    const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
    const MapDelta delta = IntegrateFrame(frame, association, {}, &map);
    merged += delta.merged.size();
    tracker.NoteChanges(map, delta);
    ExpectSame(tracker.Summarize(map, AllPlaces(map), {}, ObjectOptions{}),
               SummarizeObjects(map, ObjectOptions{}));
  }
  EXPECT_EQ(merged, 1u);
}

}  // namespace
}  // namespace vismap
