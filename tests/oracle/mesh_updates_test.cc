// A mesh that is updated with the changes of a map equals a new mesh of the whole map.
#include <gtest/gtest.h>

#include "support/followed_mesh.h"
#include "support/recorded_map.h"

namespace vismap {
namespace {

TEST(MeshUpdates, LeaveOutWhatNoChangeReaches) {
  testing_support::FollowedMesh followed({});
  testing_support::MakeRecordedMap(testing_support::BenchSequence(), 8, {0.03, 4},
                                   [&](const SemanticMap& map, const MapDelta& delta) {
                                     followed.Follow(map, delta);
                                     followed.ExpectUpToDate(map);
                                   });
  EXPECT_GT(followed.surfaces(), 1000u);
  EXPECT_LT(followed.meshed(), followed.whole() * 9 / 10);
}

}  // namespace
}  // namespace vismap
