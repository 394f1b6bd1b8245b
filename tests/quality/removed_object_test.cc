// An object stands in the room for the first tour and is gone, or elsewhere, in the second.
#include <gtest/gtest.h>

#include "offline_mapper/offline_mapper.h"
#include "session/outputs.h"
#include "simulation/room.h"
#include "simulation/sequence.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

constexpr uint16_t kChair = 8, kSmallBox = 16;  // in the room
constexpr char kTwoTours[] = "synthetic:room?frames=40&width=320&tours=2";

struct Mapped {
  MapSession session{{VoxelGridOptions{0.02, 4.0}, {}, {}}, {}};
  MapProducts products;
};

Mapped Map(const std::string& name) {
  Mapped mapped;
  StageTimes times;
  const auto dataset = OpenSequence(name, "", {});
  const auto detections = OpenDetections(name);
  if (!dataset || !detections) throw std::runtime_error("the room can be opened");
  const auto proceed = [](size_t) { return true; };
  const auto done =
      MapSequence({**dataset, detections->get()}, {}, proceed, &mapped.session, &times);
  if (!done) throw std::runtime_error(done.error().message);
  mapped.products = MakeProducts(mapped.session.map(), mapped.session.metadata(), {});
  return mapped;
}

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
  const Mapped all = Map(kTwoTours), without = Map(Without(kChair));
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
  const Mapped without = Map(Without(kChair));
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
  const Mapped without = Map(Without(kSmallBox));
  int removed = 0;
  for (const ObjectSummary& object : without.products.objects) removed += object.removed() ? 1 : 0;
  EXPECT_GE(removed, 1);
  const Scene room = MakeRoom();
  EXPECT_LT(VerticesOn(*FindObject(room, kSmallBox), without.products.mesh), 50);
}

}  // namespace
}  // namespace vismap
