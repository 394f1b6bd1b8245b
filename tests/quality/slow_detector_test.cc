// A detector that looks at one frame in thirty: a missing mask is no evidence against an object.
#include <gtest/gtest.h>

#include "quality/mapped_sequence.h"
#include "simulation/room.h"

namespace vismap {
namespace {

using testing_support::FindInMesh;
using testing_support::Mapped;
using testing_support::Seen;

TEST(SlowDetector, KnownObjectsHaveTheirClassesThoughOneFrameInThirtyHasMasks) {
  const Scene room = MakeRoom();
  const Mapped slow =
      testing_support::MapAll("synthetic:room?frames=300&width=320&rate=30&detect_every=30");
  const Mapped fast = testing_support::MapAll("synthetic:room?frames=300&width=320&rate=30");
  int known = 0, found = 0;
  for (const SceneObject& object : room.objects) {
    const Seen seen = FindInMesh(room, object.id, slow.products.mesh);
    if (object.kind != ObjectKind::kKnown) {
      EXPECT_EQ(seen.class_id, ClassId::kUnknown) << object.name;
      continue;
    }
    const Seen best = FindInMesh(room, object.id, fast.products.mesh);
    if (best.class_id != object.class_id || best.share < 0.5) continue;
    ++known;
    if (seen.class_id == object.class_id && seen.share > 0.5) ++found;
  }
  EXPECT_GE(known, 8);
  EXPECT_GE(found, known - 1);
}

}  // namespace
}  // namespace vismap
