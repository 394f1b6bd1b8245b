#include "objects/objects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "objects/label_surfaces.h"
#include "objects/map_mesh.h"
#include "objects/object_mesh.h"
#include "support/analytic_room.h"
#include "support/mesh_checks.h"

namespace vismap {
namespace {

using namespace testing_support;
using Eigen::Vector3d;
using ::testing::ElementsAre;

TEST(SummarizeObjects, InstancesFirstThenDiscoveredSegments) {
  const auto objects = SummarizeObjects(AnalyticRoom());
  ASSERT_EQ(objects.size(), 3u);
  EXPECT_EQ(objects[0].instance, InstanceId{5});
  EXPECT_THAT(objects[0].segments, ElementsAre(kBoxLeft, kBoxRight));
  EXPECT_THAT(objects[1].segments, ElementsAre(kFloor));
  EXPECT_THAT(objects[2].segments, ElementsAre(kBall));
  EXPECT_TRUE(objects[2].discovered());
}

TEST(SummarizeObjects, BoxOfATurnedBoxIsTheTruth) {
  const OrientedBox box = SummarizeObjects(AnalyticRoom())[0].box;
  EXPECT_LT((box.center_W - kBoxCenter).norm(), kVoxel);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(box.size[i], 2 * kBoxHalf[i], kVoxel) << i;
  const Vector3d along = box.R_W_B * Vector3d::UnitX();
  const Vector3d truth(std::cos(kYaw), std::sin(kYaw), 0);
  EXPECT_GT(std::abs(along.dot(truth)), std::cos(2 * std::numbers::pi / 180));
  EXPECT_LT((box.R_W_B * Vector3d::UnitZ() - Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(SummarizeObjects, ClassHasMostEvidenceOverSurface) {
  const ObjectSummary chair = SummarizeObjects(AnalyticRoom())[0];
  // Nine votes on a third of the surface lose against eight on the rest.
  EXPECT_EQ(chair.class_id, kChair);
  ASSERT_EQ(chair.class_probability.size(), 2u);
  EXPECT_NEAR(chair.class_probability.at(kChair) + chair.class_probability.at(kTv), 1, 1e-9);
  EXPECT_GT(chair.class_probability.at(kChair), 0.5);
  EXPECT_GT(chair.score, 0);
  EXPECT_LT(chair.score, chair.class_probability.at(kChair));
}

TEST(SummarizeObjects, MoreConfirmationsScoreHigher) {
  SemanticMap often = AnalyticRoom(), seldom = AnalyticRoom();
  AddEvidence(&often, kBall, InstanceId{6}, kChair, 16, 18);
  AddEvidence(&seldom, kBall, InstanceId{6}, kChair, 16, 6);
  EXPECT_GT(SummarizeObjects(often)[1].score, SummarizeObjects(seldom)[1].score);
}

TEST(SummarizeObjects, CountsSurfaceFramesAndTimes) {
  SemanticMap map = AnalyticRoom();
  map.labels.MutableRecord(kBoxLeft).first_utime = 500;
  const Mesh mesh = ExtractMesh(map);
  const auto objects = SummarizeObjects(map, mesh);
  EXPECT_EQ(objects[0].frames, 20u);
  EXPECT_EQ(objects[0].first_utime, 500);
  EXPECT_EQ(objects[0].last_utime, 1'000'000);
  int64_t points = 0;
  double area = 0;
  for (const ObjectSummary& object : objects) {
    points += object.points;
    area += object.area;
  }
  EXPECT_EQ(points, static_cast<int64_t>(mesh.vertices.size()));
  const double ball = 4 * std::numbers::pi * 0.15 * 0.15;
  EXPECT_NEAR(objects[2].area, ball, 0.03 * ball);
  EXPECT_GT(area, 3);
}

TEST(SummarizeObjects, OnlyTheFloorIsStructure) {
  const auto objects = SummarizeObjects(AnalyticRoom());
  EXPECT_FALSE(objects[0].is_structure());
  EXPECT_TRUE(objects[1].is_structure());
  EXPECT_FALSE(objects[2].is_structure());
}

TEST(SummarizeObjects, StrayPiecesDoNotBlowUpTheBox) {
  SemanticMap map = AnalyticRoom();
  Mesh mesh = ExtractMesh(map);
  // A mask reached surface far behind the object.
  for (int i = 0; i < 30; ++i) {
    MeshVertex stray;
    stray.position_W = Eigen::Vector3f(4, 4, 0.01F * static_cast<float>(i));
    stray.segment = kBoxLeft;
    mesh.vertices.push_back(stray);
  }
  EXPECT_LT(SummarizeObjects(map, mesh)[0].box.size.maxCoeff(), 0.7);
}

TEST(SummarizeObjects, UpAxisIsAnOption) {
  // The same room, told that y is up: the third axis of the box is y.
  const OrientedBox box = SummarizeObjects(AnalyticRoom(), {.up_W = Vector3d::UnitY()})[2].box;
  EXPECT_LT((box.R_W_B * Vector3d::UnitZ() - Vector3d::UnitY()).norm(), 1e-9);
  EXPECT_NEAR(box.size.z(), 0.3, kVoxel);
  EXPECT_NEAR(box.R_W_B.toRotationMatrix().determinant(), 1, 1e-9);
}

TEST(SummarizeObjects, WhatWasSeenEmptyIsRemovedOnceLittleOfItIsLeft) {
  SemanticMap map = AnalyticRoom();
  const auto before = SummarizeObjects(map);
  LabelRecord& ball = map.labels.MutableRecord(kBall);
  ball.cleared_utime = 7;
  ball.cleared_voxels = static_cast<uint32_t>(before[2].points);  // but all of it is still there
  EXPECT_FALSE(SummarizeObjects(map)[2].removed());
  ball.cleared_voxels = static_cast<uint32_t>(3 * before[2].points);
  const auto after = SummarizeObjects(map);
  ASSERT_EQ(after.size(), 3u);
  EXPECT_TRUE(after[2].removed());
  EXPECT_EQ(after[2].removed_utime, 7);
  EXPECT_EQ(after[2].frames, before[2].frames);
  EXPECT_EQ(after[2].box.size.norm(), 0);
  EXPECT_TRUE(CutObjects(ExtractMesh(map), after)[2].triangles.empty());
  EXPECT_FALSE(SummarizeObjects(map, {.removed_max_rest = 0})[2].removed());
}

TEST(SummarizeObjects, OfWhatWasRemovedTheLastIsListedForAWhile) {
  constexpr int64_t kSecond = 1'000'000, kLabels = 20;
  SemanticMap map(kGrid);
  map.labels.GrowLabels(SegmentLabel{kLabels + 2});
  for (uint32_t label = 1; label <= kLabels; ++label) {
    LabelRecord& record = map.labels.MutableRecord(SegmentLabel{label});
    record.frames = 9;
    record.cleared_voxels = 1000;
    record.cleared_utime = label * kSecond;
  }
  map.labels.MutableRecord(SegmentLabel{kLabels + 1}).last_utime = 30 * kSecond;
  const auto listed = [&](const ObjectOptions& options) {
    std::vector<uint32_t> labels;
    for (const ObjectSummary& object : SummarizeObjects(map, options)) {
      EXPECT_TRUE(object.removed());
      labels.push_back(Raw(object.segments.front()));
    }
    return labels;
  };
  EXPECT_EQ(listed({}).size(), 20u);
  EXPECT_THAT(listed({.removed_max_count = 3}), ElementsAre(18, 19, 20));
  EXPECT_THAT(listed({.removed_max_age_s = 11.5}), ElementsAre(19, 20));
  EXPECT_EQ(listed({.removed_max_age_s = 0}).size(), 20u);
  EXPECT_TRUE(listed({.removed_max_count = 0}).empty());
}

TEST(SummarizeObjects, WhatFewFramesSawIsNoThingUnlessADetectorNamedIt) {
  SemanticMap map = AnalyticRoom();
  for (const SegmentLabel label : {kFloor, kBoxLeft, kBoxRight, kBall})
    map.labels.MutableRecord(label).frames = 2;
  const auto objects = SummarizeObjects(map);
  ASSERT_EQ(objects.size(), 2u);
  EXPECT_EQ(objects[0].instance, InstanceId{5});
  EXPECT_EQ(objects[1].structure, StructureKind::kFloor);
  EXPECT_EQ(SummarizeObjects(map, {.min_discovered_frames = 2}).size(), 3u);
  map.labels.MutableRecord(kBall).cleared_voxels = 1'000'000;
  EXPECT_EQ(SummarizeObjects(map).size(), 2u) << "nor was what is gone";
}

/// A discovered segment with this area [m^2], evenly spread over a rectangle with sides x and y
/// [m].
ObjectSummary Spread(double x, double y, double area) {
  ObjectSummary object;
  object.segments = {kBall};
  object.frames = 10;
  object.area = area;
  object.spread.covariance_W.diagonal() = Vector3d(x * x, y * y, 1e-6) / 12;
  return object;
}

TEST(EraseInsignificant, LeavesThingsOfSomeSizeThatAreInOnePiece) {
  std::vector<ObjectSummary> objects{
      Spread(0.2, 0.1, 0.02),    // a plate
      Spread(0.1, 0.1, 0.05),    // a body
      Spread(0.05, 0.1, 0.005),  // too small
      Spread(1.2, 0.03, 0.03),   // a broomstick
      Spread(1.2, 0.5, 0.03),    // specks on a wall
  };
  objects.push_back(objects.back());
  objects.back().structure = StructureKind::kWall;
  EraseInsignificant({}, &objects);
  ASSERT_EQ(objects.size(), 4u);
  EXPECT_EQ(objects[0].area, 0.02);
  EXPECT_EQ(objects[1].area, 0.05);
  EXPECT_EQ(objects[2].area, 0.03);
  EXPECT_FALSE(objects[2].is_structure());
  EXPECT_TRUE(objects[3].is_structure());
}

TEST(EraseInsignificant, LimitsAreOptions) {
  const auto left = [](const ObjectOptions& options) {
    std::vector<ObjectSummary> objects{Spread(0.05, 0.1, 0.005), Spread(1.2, 0.5, 0.03)};
    EraseInsignificant(options, &objects);
    return objects.size();
  };
  EXPECT_EQ(left({}), 0u);
  EXPECT_EQ(left({.min_discovered_area_m2 = 0}), 1u);
  EXPECT_EQ(left({.min_discovered_fill = 0}), 1u);
  EXPECT_EQ(
      left({.min_discovered_frames = 11, .min_discovered_area_m2 = 0, .min_discovered_fill = 0}),
      0u);
}

TEST(SummarizeObjects, EmptyMapHasNoObjects) {
  EXPECT_TRUE(SummarizeObjects(SemanticMap(kGrid)).empty());
}

TEST(CutObjects, PiecesAreTheWholeMeshAndFitTogether) {
  const SemanticMap map = AnalyticRoom();
  const Mesh mesh = ExtractMesh(map);
  const auto objects = SummarizeObjects(map, mesh);
  const std::vector<Mesh> parts = CutObjects(mesh, objects);
  ASSERT_EQ(parts.size(), objects.size());
  TriangleSet whole, cut;
  AppendTriangles(mesh, &whole);
  for (const Mesh& part : parts) AppendTriangles(part, &cut);
  std::sort(whole.begin(), whole.end());
  std::sort(cut.begin(), cut.end());
  EXPECT_EQ(whole, cut);
}

TEST(CutObjects, MajorityOfTheCornersDecides) {
  Mesh mesh;
  mesh.vertices.resize(3);
  mesh.vertices[0].segment = kFloor;
  mesh.vertices[1].segment = mesh.vertices[2].segment = kBall;
  mesh.triangles = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 0, 1}};
  std::vector<ObjectSummary> objects(2);
  objects[0].segments = {kFloor};
  objects[1].segments = {kBall};
  const auto parts = CutObjects(mesh, objects);
  EXPECT_EQ(parts[0].triangles.size(), 1u);
  EXPECT_EQ(parts[1].triangles.size(), 3u);
  EXPECT_EQ(parts[1].vertices.size(), 3u);
}

TEST(ObjectFileName, IsSafe) {
  ObjectSummary object;
  object.segments = {kBall};
  EXPECT_EQ(ObjectFileName(object, "chair"), "segment_4");
  object.instance = InstanceId{7};
  EXPECT_EQ(ObjectFileName(object, "dining table/../x"), "instance_7_dining_table____x");
}

}  // namespace
}  // namespace vismap
