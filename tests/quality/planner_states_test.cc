// A sphere that touches no occupied leaf of the closed tree collides with nothing and lies in space
// that the camera saw, also beyond the bounds of the tree, where it has a shell.
#include <gtest/gtest.h>

#include "freespace/octree.h"
#include "freespace/octree_reading.h"
#include "quality/mapped_sequence.h"
#include "support/pipelines.h"
#include "support/planner_scenes.h"

namespace vismap {
namespace {

using testing_support::PlannerScene;
using testing_support::StateScore;

constexpr int kStates = 20000;
constexpr double kSphereRadius = 0.2, kWider = 0.8;  // [m]

std::unique_ptr<octomap::OcTree> ClosedTree(const Dataset& dataset) {
  MapSession session({}, {});
  testing_support::MapFrames(dataset, {}, SIZE_MAX, &session);
  const auto octree =
      BuildOctree(ClassifyMap(session.map(), {}),
                  {.resolution_m = 0.05, .unknown = UnknownPolicy::kOccupied, .bounds_W = {}});
  if (!octree) throw std::runtime_error(octree.error().message);
  auto tree = testing_support::ReadOctree(octree->bytes, "closed");
  if (!tree) throw std::runtime_error(tree.error().message);
  return std::move(*tree);
}

StateScore Score(const PlannerScene& scene) {
  const auto tree = ClosedTree(*scene.dataset);
  const StateScore states = testing_support::ScoreStates(
      *tree, scene.truth, testing_support::Wider(testing_support::BoundsOfFree(*tree), kWider),
      kStates, kSphereRadius, testing_support::AbsentLeaves::kFree);
  const auto cells = scene.signed_distance
                         ? testing_support::CountFalseFree(*tree, scene.signed_distance)
                         : testing_support::FalseFree{};
  Print(scene.name, cells, states);
  return states;
}

void ExpectSafe(const StateScore& states, double least_usable) {
  EXPECT_EQ(states.colliding, 0);
  EXPECT_EQ(states.unseen, 0);
  EXPECT_GT(states.called_free, 100);
  EXPECT_GT(states.usable_share(), least_usable);
}

TEST(PlannerStates, AreSafeInTheRoom) {
  ExpectSafe(Score(testing_support::SyntheticPlannerScene("synthetic:room?frames=80")), 0.6);
}

TEST(PlannerStates, AreSafeInTheRoomWhenPosesAreOffByTwoCentimetres) {
  for (const char* seed : {"1", "2", "3"}) {
    PlannerScene scene = testing_support::SyntheticPlannerScene(
        std::string("synthetic:room?frames=80&pose_noise=0.02&seed=") + seed);
    scene.truth.tolerance = 0.1;  // three standard deviations more
    ExpectSafe(Score(scene), 0.4);
  }
}

TEST(PlannerStates, AreSafeInAnOpenHall) {
  ExpectSafe(Score(testing_support::HallPlannerScene()), 0.6);
}

TEST(PlannerStates, AreSafeInARecordedScene) {
  const auto path = testing_support::RecordedSequence("scenes/101");
  if (!path) GTEST_SKIP() << "VISMAP_DATA is not set, or has no scenes/101";
  ExpectSafe(Score(testing_support::RecordedPlannerScene(*path)), 0.6);
}

}  // namespace
}  // namespace vismap
