#include <gtest/gtest.h>

#include "evaluation/scores.h"
#include "exports/outputs.h"
#include "sequence_mapper/map_sequence.h"
#include "simulation/room.h"
#include "simulation/sequence.h"
#include "support/mesh_scores.h"

namespace vismap {
namespace {

using testing_support::GeometryScore;
using testing_support::ScoreGeometry;
using testing_support::ScoreObjects;

// The built-in room with sensor noise and an imperfect detector, mapped at 2 cm; made once for all
// claims below.
class RoomMap {
 public:
  static const RoomMap& Get() {
    static const RoomMap room;
    return room;
  }

  Scene scene = MakeRoom();
  StageTimes times;
  MapSession session{{VoxelGridOptions{0.02, 4.0}, {}, {}}, {}};
  MapProducts products;

  double Distance(const Eigen::Vector3d& p_W) const { return SignedDistance(scene, p_W); }

  // The object that each vertex lies on: the nearest one within 4 cm.
  std::vector<uint16_t> TruthOfVertices() const {
    std::vector<uint16_t> truth;
    for (const MeshVertex& vertex : products.mesh.vertices) {
      double nearest = 0.04;
      uint16_t id = 0;
      for (const SceneObject& object : scene.objects) {
        const double distance = std::abs(SignedDistance(object, vertex.position_W.cast<double>()));
        if (distance >= nearest) continue;
        nearest = distance;
        id = object.id;
      }
      truth.push_back(id);
    }
    return truth;
  }

 private:
  RoomMap() {
    const std::string name = "synthetic:room?frames=40&width=320";
    const auto dataset = OpenSequence(name, "", {});
    const auto detections = OpenDetections(name);
    if (!dataset || !detections)
      throw std::runtime_error(dataset ? detections.error().message : dataset.error().message);
    const auto proceed = [](size_t) { return true; };
    const auto mapped = MapSequence({**dataset, detections->get()}, {}, proceed, &session, &times);
    if (!mapped) throw std::runtime_error(mapped.error().message);
    products = MakeProducts(session.map(), session.metadata(), {});
  }
};

TEST(RoomQuality, TheSurfaceIsWithinAVoxelOfTheTruth) {
  const RoomMap& room = RoomMap::Get();
  const GeometryScore score =
      ScoreGeometry(room.products.mesh, [&](const Eigen::Vector3d& p) { return room.Distance(p); });
  RecordProperty("mean_mm", std::to_string(score.mean * 1e3));
  EXPECT_GT(score.vertices, 20000);
  EXPECT_LT(score.mean, 0.008);
  EXPECT_LT(score.p95, 0.03);
}

TEST(RoomQuality, KnownObjectsAreFoundWithTheirClass) {
  const RoomMap& room = RoomMap::Get();
  const auto scores = ScoreObjects(room.products.mesh, room.TruthOfVertices());
  int known = 0, found = 0, named = 0;
  for (const SceneObject& object : room.scene.objects) {
    const auto score = scores.find(object.id);
    if (object.kind != ObjectKind::kKnown || score == scores.end() || score->second.vertices < 60)
      continue;
    ++known;
    if (score->second.iou <= 0.5) continue;
    ++found;
    if (score->second.class_id == object.class_id) ++named;
  }
  EXPECT_GE(known, 8);
  EXPECT_GE(found, known - 1);
  EXPECT_EQ(named, found);
}

TEST(RoomQuality, NothingUnknownGetsAClass) {
  const RoomMap& room = RoomMap::Get();
  const auto scores = ScoreObjects(room.products.mesh, room.TruthOfVertices());
  int unknown = 0, found = 0;
  for (const SceneObject& object : room.scene.objects) {
    const auto score = scores.find(object.id);
    if (object.kind == ObjectKind::kKnown || score == scores.end() || score->second.vertices < 60)
      continue;
    EXPECT_EQ(score->second.class_id, ClassId::kUnknown) << object.name;
    if (object.kind != ObjectKind::kUnknown) continue;
    ++unknown;
    if (score->second.iou > 0.5) ++found;
  }
  EXPECT_GE(unknown, 3);
  EXPECT_GE(2 * found, unknown);
}

TEST(RoomQuality, FreeSpaceHoldsNoSolid) {
  const RoomMap& room = RoomMap::Get();
  const OccupancyMap occupancy = ClassifyMap(room.session.map(), {});
  const FreeSpaceScore score = ScoreFreeSpace(
      occupancy, [&](const Eigen::Vector3d& p) { return room.Distance(p); }, 0.04);
  EXPECT_GT(score.free_cells, 1000000);
  EXPECT_LT(static_cast<double>(score.free_but_solid),
            1e-4 * static_cast<double>(score.free_cells));
  EXPECT_LT(static_cast<double>(score.occupied_but_free),
            0.05 * static_cast<double>(score.occupied_cells));
}

}  // namespace
}  // namespace vismap
