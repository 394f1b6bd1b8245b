#include "objects/object_tracker.h"

#include <gtest/gtest.h>

#include <map>

#include "map/surface_reader.h"
#include "mapping/integrate.h"
#include "objects/map_mesh.h"
#include "objects/read_out.h"
#include "support/mesh_blocks.h"
#include "support/plane_frames.h"

namespace vismap {
namespace {

using testing_support::LookAtWall;
using testing_support::MeshBlocks;

/// The blocks in which a label has votes, found by checking all blocks.
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

/// The surfaces of all blocks of a map.
BlockSurfaces Surfaces(const SemanticMap& map) {
  BlockSurfaces surfaces;
  for (const BlockMesh& block : MeshBlocks(map, map.voxels.SortedIndices(), ShowLabels(map.labels)))
    surfaces.Update(block, map.voxels.voxel_size());
  return surfaces;
}

/// Options whose boxes contain all points, because outliers would depend on a few points.
ObjectOptions WholeBoxes() {
  ObjectOptions options;
  options.box_outliers = 0;
  return options;
}

/// The objects of the mesh of the whole map. Contacts are off, because block meshes do not have
/// them.
std::vector<ObjectSummary> WholeObjects(const SemanticMap& map, const ObjectOptions& options) {
  MeshingOptions meshing;
  meshing.contact_voxels = 0;
  return SummarizeObjects(map, ExtractMesh(map, meshing), options);
}

void ExpectSame(const std::vector<ObjectSummary>& a, const std::vector<ObjectSummary>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].instance, b[i].instance);
    EXPECT_EQ(a[i].segments, b[i].segments);
    EXPECT_EQ(a[i].class_id, b[i].class_id);
    EXPECT_EQ(a[i].state, b[i].state);
    // Vertices at the border of the observed space, on the face between two blocks, may be missing.
    EXPECT_NEAR(static_cast<double>(a[i].points), static_cast<double>(b[i].points),
                0.02 * static_cast<double>(b[i].points));
    EXPECT_NEAR(a[i].score, b[i].score, 1e-2);
    EXPECT_NEAR(a[i].area, b[i].area, 1e-7);
    EXPECT_EQ(a[i].is_structure(), b[i].is_structure());
    // Boxes are fitted to a sample of the points, so a strip with a thin connection may be left
    // out.
    EXPECT_LT((a[i].box.size - b[i].box.size).cwiseAbs().maxCoeff(), 0.11);
    EXPECT_LT((a[i].box.center_W - b[i].box.center_W).norm(), 0.11);
  }
}

TEST(ObjectTracker, FollowsAGrowingMap) {
  SemanticMap map({0.02, 4});
  ObjectTracker tracker;
  const ObjectOptions options = WholeBoxes();
  for (int i = 0; i < 8; ++i) {
    SegmentedFrame frame = LookAtWall(1.5, {0.1 * i, 0, 0});
    testing_support::SplitAtColumn(70 - 9 * i, frame);
    testing_support::Detect(1, 0, ClassId{62}, frame);
    const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
    IntegrateFrame(frame, association, {}, &map);
    const std::vector<ObjectSummary> objects =
        tracker.Summarize(map, Surfaces(map), AllPlaces(map), options);
    ExpectSame(objects, WholeObjects(map, options));
  }
}

/// A frame of a plate that covers most of a wall and has its own segment.
SegmentedFrame PlateBeforeWall(int u_end) {
  SegmentedFrame frame = LookAtWall(2.0);
  testing_support::SplitAtColumn(u_end, frame);
  for (int v = 0; v < frame.frame.depth.height(); ++v) {
    for (int u = 0; u < u_end; ++u) frame.frame.depth(v, u) = 1.2F;
  }
  testing_support::Detect(0, 0, ClassId{62}, frame);
  return frame;
}

TEST(ObjectTracker, SeesThatSomethingWasRemovedLargeOrSmall) {
  for (const int u_end : {30, 140}) {
    SemanticMap map({0.01, 4});
    ObjectTracker tracker;
    for (int i = 0; i < 16; ++i) {
      const SegmentedFrame frame = i < 8 ? PlateBeforeWall(u_end) : LookAtWall(2.0);
      const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
      IntegrateFrame(frame, association, {}, &map);
      const auto objects = tracker.Summarize(map, Surfaces(map), AllPlaces(map), ObjectOptions{});
      const auto all = SummarizeObjects(map, ObjectOptions{});
      ASSERT_EQ(objects.size(), all.size());
      for (size_t j = 0; j < all.size(); ++j) {  // boxes of large objects may be older
        EXPECT_EQ(objects[j].segments, all[j].segments);
        EXPECT_EQ(objects[j].state, all[j].state);
      }
      EXPECT_TRUE(i > 7 || !objects.back().removed());
    }
    const ObjectSummary plate =
        tracker.Summarize(map, Surfaces(map), AllPlaces(map), ObjectOptions{}).back();
    EXPECT_TRUE(plate.removed());
    EXPECT_EQ(plate.class_id, ClassId{62});
    EXPECT_EQ(plate.box.size.norm(), 0);
  }
}

TEST(ObjectTracker, AMergedLabelIsNotAnObjectOfItsOwn) {
  SemanticMap map({0.02, 4});
  ObjectTracker tracker;
  SegmentedFrame split = LookAtWall(1.5);
  testing_support::SplitAtColumn(70, split);
  size_t merged = 0;
  for (int i = 0; i < 12; ++i) {
    const SegmentedFrame frame = i < 3 ? split : LookAtWall(1.5);
    const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
    const MapDelta delta = IntegrateFrame(frame, association, {}, &map);
    merged += delta.merged.size();
    ExpectSame(tracker.Summarize(map, Surfaces(map), AllPlaces(map), WholeBoxes()),
               WholeObjects(map, WholeBoxes()));
  }
  EXPECT_EQ(merged, 1u);
}

}  // namespace
}  // namespace vismap
