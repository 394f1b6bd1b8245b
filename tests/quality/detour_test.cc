// Objects that the camera comes back to after a detour keep their ids.
#include <gtest/gtest.h>

#include "quality/mapped_sequence.h"
#include "simulation/room.h"

namespace vismap {
namespace {

using testing_support::Continue;
using testing_support::FindInMesh;
using testing_support::Mapped;
using testing_support::Seen;

/// How the mesh shows the objects of a kind, by name and id.
std::map<std::string, Seen> SeenObjects(const Scene& scene, ObjectKind kind, const Mesh& mesh) {
  std::map<std::string, Seen> objects;
  for (const SceneObject& object : scene.objects) {
    if (object.kind != kind) continue;
    const Seen seen = FindInMesh(scene, object.id, mesh);
    if (seen.vertices > 100 && seen.share > 0.5)
      objects[object.name + " " + std::to_string(object.id)] = seen;
  }
  return objects;
}

class Detour : public ::testing::TestWithParam<const char*> {};

// The camera makes several tours of the room. It sees every object again after 80 frames, with
// other errors each time.
TEST_P(Detour, ObjectsAreFoundAgainWithTheirIds) {
  const Scene room = MakeRoom();
  Mapped mapped;
  Continue(GetParam(), nullptr, 80, &mapped);
  const auto named = SeenObjects(room, ObjectKind::kKnown, mapped.products.mesh);
  const auto discovered = SeenObjects(room, ObjectKind::kUnknown, mapped.products.mesh);
  EXPECT_GE(named.size(), 9u);
  EXPECT_GE(discovered.size(), 4u);
  Continue(GetParam(), nullptr, 240, &mapped);
  for (const auto& [name, before] : named) {
    const Seen now = SeenObjects(room, ObjectKind::kKnown, mapped.products.mesh)[name];
    EXPECT_EQ(now.instance, before.instance) << name;
    EXPECT_EQ(now.class_id, before.class_id) << name;
  }
  for (const auto& [name, before] : discovered) {
    const Seen now = SeenObjects(room, ObjectKind::kUnknown, mapped.products.mesh)[name];
    EXPECT_EQ(now.segment, before.segment) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Room, Detour,
                         ::testing::Values("synthetic:room?frames=80&width=320&tours=3",
                                           "synthetic:room?frames=80&width=320&tours=3&seed=2"));

}  // namespace
}  // namespace vismap
