// An object stands in the room for the first tour and is gone, or elsewhere, in the second.
#include <gtest/gtest.h>

#include "freespace/occupancy_map.h"
#include "quality/mapped_sequence.h"
#include "simulation/room.h"
#include "simulation/synthetic_dataset.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using testing_support::MapAll;
using testing_support::Mapped;

constexpr uint16_t kChair = 8, kSmallBox = 16;  // in the room
constexpr char kTwoTours[] = "synthetic:room?frames=40&width=320&tours=2";

std::string Without(uint16_t id) {
  return std::string(kTwoTours) + "&remove=" + std::to_string(id) + "@41";
}

/// Mesh vertices within 2 cm of an object and farther than 10 cm from all others.
int VerticesOn(const SceneObject& object, const Mesh& mesh) {
  Scene others = MakeRoom();
  std::erase_if(others.objects, [&](const SceneObject& o) { return o.id == object.id; });
  int count = 0;
  for (const MeshVertex& vertex : mesh.vertices) {
    const Eigen::Vector3d p = vertex.position_W.cast<double>();
    if (std::abs(SignedDistance(object, p)) < 0.02 && SignedDistance(others, p) > 0.1) ++count;
  }
  return count;
}

TEST(RemovedObject, DisappearsFromMapAndIsListedAsRemovedWhileTheRestStays) {
  const Scene room = MakeRoom();
  const SceneObject& chair = *FindObject(room, kChair);
  const Mapped all = MapAll(kTwoTours);
  const Mapped without = MapAll(Without(kChair));
  const int before = VerticesOn(chair, all.products.mesh);
  EXPECT_GT(before, 500);
  EXPECT_LT(VerticesOn(chair, without.products.mesh), 0.02 * before);

  int removed = 0;
  std::set<InstanceId> present;
  for (const ObjectSummary& object : without.products.objects) {
    if (!object.removed()) present.insert(object.instance);
    if (!object.removed() || object.discovered()) continue;
    ++removed;
    EXPECT_EQ(object.class_id, chair.class_id);
    EXPECT_LE(object.last_utime, 4'000'000);
    EXPECT_GT(object.removed_utime, 4'000'000);
  }
  EXPECT_EQ(removed, 1);
  for (const ObjectSummary& object : all.products.objects) {
    EXPECT_FALSE(object.removed()) << Raw(object.instance);
    if (object.discovered() || present.contains(object.instance)) continue;
    EXPECT_EQ(object.class_id, chair.class_id) << Raw(object.instance);
  }
  for (const SceneObject& object : room.objects) {
    if (object.kind == ObjectKind::kStructure || object.id == kChair) continue;
    const int here = VerticesOn(object, all.products.mesh);
    EXPECT_NEAR(VerticesOn(object, without.products.mesh), here, 0.03 * here + 10) << object.name;
  }
}

TEST(RemovedObject, ItsRecordSurvivesTheFile) {
  const Mapped without = MapAll(Without(kChair));
  const TempFolder folder;
  const auto path = folder.path() / "map.vismap";
  ASSERT_TRUE(SaveMap(without.session.map(), without.session.metadata(), path));
  const auto loaded = LoadMap(path);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const MapProducts again = MakeProducts(loaded->map, loaded->metadata, {});
  EXPECT_EQ(ObjectsText(loaded->metadata, again),
            ObjectsText(without.session.metadata(), without.products));
}

TEST(RemovedObject, ADiscoveredOneIsListed) {
  const Mapped without = MapAll(Without(kSmallBox));
  int removed = 0;
  for (const ObjectSummary& object : without.products.objects) removed += object.removed() ? 1 : 0;
  EXPECT_GE(removed, 1);
  const Scene room = MakeRoom();
  EXPECT_LT(VerticesOn(*FindObject(room, kSmallBox), without.products.mesh), 50);
}

/// Cells that are occupied within 2 cm of an object and farther than 10 cm from all others.
int OccupiedCellsOn(const SceneObject& object, const Scene& scene, const OccupancyMap& occupancy) {
  constexpr double kCell = 0.02;
  Scene others = scene;
  std::erase_if(others.objects, [&](const SceneObject& o) { return o.id == object.id; });
  const Eigen::AlignedBox3d box = BoundingBox(object);
  const Eigen::Array3i low = (box.min() / kCell).array().floor().cast<int>() - 1;
  const Eigen::Array3i high = (box.max() / kCell).array().floor().cast<int>() + 1;
  int count = 0;
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        const Eigen::Vector3d p = kCell * (Eigen::Vector3d(x, y, z).array() + 0.5);
        if (occupancy.At(p) == CellState::kOccupied && std::abs(SignedDistance(object, p)) < 0.02 &&
            SignedDistance(others, p) > 0.1) {
          ++count;
        }
      }
    }
  }
  return count;
}

TEST(RemovedObject, MovedByAMetreIsGoneFromItsOldPlaceAndStandsAtTheNewOne) {
  const std::string moved = "synthetic:room?frames=80&width=320&tours=2&move=8@81,-0.8,0.6";
  const Scene scene = MakeScene(*ParseSyntheticPath(moved));
  const SceneObject& before = *FindObject(scene, kChair);
  const SceneObject& after = scene.objects.back();
  Scene first = SceneInFrame(scene, 1);
  Scene last = SceneInFrame(scene, 160);
  last.objects.push_back(before);  // surfaces that are near neither

  Mapped mapped;
  testing_support::Continue(moved, nullptr, 80, &mapped);
  const int vertices = VerticesOn(before, mapped.products.mesh);
  const int cells = OccupiedCellsOn(before, first, ClassifyMap(mapped.session.map(), {}));
  testing_support::Continue(moved, nullptr, 160, &mapped);
  const OccupancyMap occupancy = ClassifyMap(mapped.session.map(), {});
  EXPECT_GT(vertices, 500);
  EXPECT_GT(cells, 500);
  EXPECT_LT(VerticesOn(before, mapped.products.mesh), 0.02 * vertices);
  EXPECT_LT(OccupiedCellsOn(before, last, occupancy), 0.02 * cells);
  EXPECT_GT(OccupiedCellsOn(after, last, occupancy), 0.5 * cells);

  const testing_support::Seen seen =
      testing_support::FindInMesh(SceneInFrame(scene, 160), after.id, mapped.products.mesh);
  EXPECT_EQ(seen.class_id, before.class_id);
  EXPECT_GT(seen.share, 0.5);
  EXPECT_GT(seen.vertices, 0.5 * vertices);
  int removed = 0;
  for (const ObjectSummary& object : mapped.products.objects) {
    if (object.instance == seen.instance) {
      EXPECT_FALSE(object.removed());
      EXPECT_LT((object.box.center_W - BoundingBox(after).center()).norm(), 0.25);
    } else if (object.removed() && object.class_id == before.class_id) {
      ++removed;
    }
  }
  EXPECT_EQ(removed, 1);
}

}  // namespace
}  // namespace vismap
