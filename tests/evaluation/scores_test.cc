#include "evaluation/scores.h"

#include <gtest/gtest.h>

#include "support/mesh_scores.h"

namespace vismap {
namespace {

using testing_support::GeometryScore;
using testing_support::ScoreGeometry;
using testing_support::ScoreObjects;

MeshVertex Vertex(double x, uint32_t segment, uint32_t instance, uint16_t class_id) {
  MeshVertex vertex;
  vertex.position_W = {static_cast<float>(x), 0, 0};
  vertex.segment = static_cast<SegmentLabel>(segment);
  vertex.instance = static_cast<InstanceId>(instance);
  vertex.class_id = static_cast<ClassId>(class_id);
  return vertex;
}

TEST(ScoreGeometry, IsTheMeanUnsignedDistanceToTheTrueSurface) {
  Mesh mesh;
  for (const double x : {-0.02, 0.0, 0.01, 0.03}) mesh.vertices.push_back(Vertex(x, 1, 0, 0));
  const GeometryScore score = ScoreGeometry(mesh, [](const Eigen::Vector3d& p) { return p.x(); });
  EXPECT_NEAR(score.mean, 0.015, 1e-6);
  EXPECT_NEAR(score.p95, 0.02, 1e-6);
}

TEST(ScoreObjects, CountsTheBestGroupAndTheFragments) {
  Mesh mesh;
  std::vector<uint16_t> truth;
  const auto add = [&](int count, uint16_t object, uint32_t segment, uint32_t instance,
                       uint16_t class_id) {
    for (int i = 0; i < count; ++i) {
      mesh.vertices.push_back(Vertex(0, segment, instance, class_id));
      truth.push_back(object);
    }
  };
  add(60, 7, 1, 3, 62);  // a chair, most of it in instance 3 ...
  add(30, 7, 2, 0, 0);   // ... and a piece of its own
  add(10, 7, 0, 0, 0);   // ... and surface without a segment
  add(20, 0, 1, 3, 62);  // instance 3 spills over
  add(50, 8, 4, 0, 0);   // a thing that was discovered
  const auto scores = ScoreObjects(mesh, truth);
  ASSERT_EQ(scores.size(), 2u);
  EXPECT_NEAR(scores.at(7).iou, 60.0 / (100 + 80 - 60), 1e-12);
  EXPECT_EQ(scores.at(7).instance, InstanceId{3});
  EXPECT_EQ(scores.at(7).class_id, ClassId{62});
  EXPECT_EQ(scores.at(7).fragments, 2);
  EXPECT_EQ(scores.at(8).iou, 1.0);
  EXPECT_EQ(scores.at(8).instance, InstanceId::kNone);
}

TEST(ScoreFreeSpace, FindsFreeCellsInSolidsAndOccupiedOnesInTheOpen) {
  OccupancyMap map(0.1);
  OccupancyPlanes planes;
  planes.free[0] = 0b00000111;      // cells x = 0, 1, 2 of the first row
  planes.occupied[0] = 0b10010000;  // x = 4 and 7
  map.Set({0, 0, 0}, BlockOccupancy(planes));
  // The solid is x < 0.2: two free cells lie in it, and the occupied one at 0.75 is 0.55 m off it.
  const FreeSpaceScore score = ScoreFreeSpace(
      map, [](const Eigen::Vector3d& p) { return p.x() - 0.2; }, 0.3);
  EXPECT_EQ(score.free_cells, 3);
  EXPECT_EQ(score.free_but_solid, 0);
  EXPECT_NEAR(score.deepest_free, 0.15, 1e-9);
  EXPECT_EQ(score.occupied_cells, 2);
  EXPECT_EQ(score.occupied_but_free, 1);
  EXPECT_EQ(ScoreFreeSpace(
                map, [](const Eigen::Vector3d& p) { return p.x() - 0.2; }, 0.01)
                .free_but_solid,
            2);
}

}  // namespace
}  // namespace vismap
