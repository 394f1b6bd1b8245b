// A sphere that touches no occupied leaf of the closed tree collides with nothing and lies in space
// that the camera saw, also beyond the bounds of the tree, where it has a shell.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "freespace/coarsen.h"
#include "quality/mapped_sequence.h"
#include "support/pipelines.h"
#include "support/planner_scenes.h"

namespace vismap {
namespace {

using testing_support::PlannerScene;
using testing_support::StateScore;

constexpr int kStates = 20000;
constexpr int kFactor = 5;
constexpr double kSphereRadius = 0.2, kWider = 0.8, kLeaf = 0.05;  // [m]

/// The map of a scene in leaves of 5 cm.
OccupancyMap LeavesOf(const Dataset& dataset) {
  MapSession session({}, {});
  testing_support::MapFrames(dataset, {}, SIZE_MAX, &session);
  return Coarsen(ClassifyMap(session.map(), {}), {kFactor, 1.0});
}

StateScore ScoreTree(const PlannerScene& scene, const octomap::OcTree& tree,
                     const Eigen::AlignedBox3d& bounds_W) {
  const StateScore states = testing_support::ScoreStates(
      tree, scene.truth, bounds_W, kStates, kSphereRadius, testing_support::AbsentLeaves::kFree);
  const auto cells = scene.signed_distance
                         ? testing_support::CountFalseFree(tree, scene.signed_distance)
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

/// Where planners may start: positions of the camera.
double StartableShare(const octomap::OcTree& tree, const std::vector<Eigen::Vector3d>& path_W) {
  const auto startable = std::count_if(path_W.begin(), path_W.end(), [&](const auto& p_W) {
    return testing_support::IsSphereFree(tree, p_W, kSphereRadius,
                                         testing_support::AbsentLeaves::kFree);
  });
  std::printf("  startable: %ld of %zu positions of the camera\n", static_cast<long>(startable),
              path_W.size());
  return static_cast<double>(startable) / static_cast<double>(path_W.size());
}

/// Spheres are safe in the closed tree, and also when the body of the robot, such a sphere around
/// the camera, counts as free; then planners may start where the camera was.
void ExpectSafeWithAndWithoutStartClearing(PlannerScene scene, double least_usable) {
  OccupancyMap leaves = LeavesOf(*scene.dataset);
  const auto tree = testing_support::ClosedTreeOf(leaves, kLeaf);
  const Eigen::AlignedBox3d bounds_W =
      testing_support::Wider(testing_support::BoundsOfFree(*tree), kWider);
  ExpectSafe(ScoreTree(scene, *tree, bounds_W), least_usable);
  const std::vector<Eigen::Vector3d> path_W = testing_support::PathOf(*scene.dataset);
  const auto cleared = testing_support::ClosedTreeOf(
      testing_support::WithStartCleared(std::move(leaves), kSphereRadius, path_W), kLeaf);
  scene.name += ", start cleared";
  scene.truth.seen.AddBody(path_W, kSphereRadius, 2 * std::sqrt(3) * kLeaf);
  ExpectSafe(ScoreTree(scene, *cleared, bounds_W), least_usable);
  EXPECT_GE(StartableShare(*cleared, path_W), 0.95);
}

TEST(PlannerStates, AreSafeInTheRoom) {
  ExpectSafeWithAndWithoutStartClearing(
      testing_support::SyntheticPlannerScene("synthetic:room?frames=80"), 0.6);
}

TEST(PlannerStates, AreSafeInTheRoomWhenPosesAreOffByTwoCentimetres) {
  for (const char* seed : {"1", "2", "3"}) {
    PlannerScene scene = testing_support::SyntheticPlannerScene(
        std::string("synthetic:room?frames=80&pose_noise=0.02&seed=") + seed);
    scene.truth.tolerance = 0.1;  // three standard deviations more
    ExpectSafeWithAndWithoutStartClearing(std::move(scene), 0.4);
  }
}

TEST(PlannerStates, AreSafeInAnOpenHall) {
  ExpectSafeWithAndWithoutStartClearing(testing_support::HallPlannerScene(), 0.6);
}

TEST(PlannerStates, AreSafeInARecordedScene) {
  const auto path = testing_support::RecordedSequence("scenes/101");
  if (!path) GTEST_SKIP() << "VISMAP_DATA is not set, or has no scenes/101";
  ExpectSafeWithAndWithoutStartClearing(testing_support::RecordedPlannerScene(*path), 0.6);
}

}  // namespace
}  // namespace vismap
