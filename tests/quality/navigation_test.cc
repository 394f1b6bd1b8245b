// What planners are given of the built-in room: where they may start, and where the map can grow.
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <vector>

#include "freespace/coarsener.h"
#include "navigation/distance_field.h"
#include "navigation/frontiers.h"
#include "navigation/inflate.h"
#include "navigation/start_clearing.h"
#include "support/occupancy_snapshot.h"
#include "support/recorded_map.h"

namespace vismap {
namespace {

constexpr int kFrames = 80;  // one tour of the room
constexpr double kRadius = 0.2;

OccupancyMap CopyOf(const OccupancyMap& leaves) {
  OccupancyMap copy(leaves.cell_size());
  EXPECT_TRUE(copy.Apply(testing_support::SnapshotOf(leaves)));
  return copy;
}

/// The tour with leaves of 5 cm: after half of it, ten frames later, and at the end.
struct Tour {
  std::vector<OccupancyMap> leaves;
  std::vector<Eigen::Vector3d> path_W;

  static const Tour& Get() {
    static const Tour tour;
    return tour;
  }

 private:
  Tour() {
    const std::string room = "synthetic:room?width=320&frames=" + std::to_string(kFrames);
    OccupancyMap voxels(0.01);
    Coarsener now(0.01, {5, 1.0});
    int frame = 0;
    testing_support::MakeRecordedMap(
        room, kFrames, {}, [&](const SemanticMap& map, const MapDelta& delta) {
          std::vector<BlockIndex> changed;
          for (const auto& block : voxels.Update(map, delta.changed_blocks, {}).blocks)
            changed.push_back(block.first);
          now.Update(voxels, changed);
          if (++frame == kFrames / 2 || frame == kFrames / 2 + 10 || frame == kFrames)
            leaves.push_back(CopyOf(now.coarse()));
        });
    const auto dataset = OpenSequence(room, "", {});
    for (size_t i = 0; i < (*dataset)->size(); ++i)
      path_W.push_back((*dataset)->Read(i)->header.T_W_C.translation());
  }
};

int Startable(const OccupancyMap& leaves, const std::vector<Eigen::Vector3d>& path_W) {
  const auto inflated = Inflate(leaves, {kRadius, UnknownPolicy::kOccupied});
  int startable = 0;
  for (const Eigen::Vector3d& p_W : path_W) startable += inflated->At(p_W) == CellState::kFree;
  return startable;
}

TEST(Navigation, PlannersMayStartWhereTheCameraWas) {
  const Tour& tour = Tour::Get();
  OccupancyMap cleared = CopyOf(tour.leaves.back());
  const auto covered = CoveredUnknownLeaves(cleared, {kRadius, 0, 0}, tour.path_W);
  ASSERT_TRUE(covered) << covered.error().message;
  for (const auto& [index, bits] : *covered)
    cleared.Set(index, WithFreeLeaves(cleared.At(index), bits));
  const int before = Startable(tour.leaves.back(), tour.path_W);
  const int after = Startable(cleared, tour.path_W);
  std::printf("startable positions of the camera: %d of %d, with start clearing %d\n", before,
              kFrames, after);
  EXPECT_LT(before, 0.8 * kFrames);
  EXPECT_GE(after, 0.95 * kFrames);
  DistanceField field = *DistanceField::Make(0.05, {});
  field.Update(tour.leaves.back(), tour.leaves.back().SortedIndices());
  const auto inflated = Inflate(cleared, {kRadius, UnknownPolicy::kOccupied});
  for (const Eigen::Vector3d& p_W : tour.path_W) {
    if (inflated->At(p_W) != CellState::kFree) continue;
    EXPECT_GE(field.FromObstacle(p_W).distance_m, kRadius) << p_W.transpose();
  }
}

/// The leaves that are free now and were unknown before.
std::set<VoxelIndex> FreedLeaves(const OccupancyMap& before, const OccupancyMap& now) {
  std::set<VoxelIndex> freed;
  for (const BlockIndex& index : now.SortedIndices()) {
    for (int i = 0; i < kBlockVoxels; ++i) {
      if (before.At(index).At(i) != CellState::kUnknown || now.At(index).At(i) != CellState::kFree)
        continue;
      freed.insert({8 * index.x + i % 8, 8 * index.y + i / 8 % 8, 8 * index.z + i / 64});
    }
  }
  return freed;
}

std::vector<VoxelIndex> BesideFaces(VoxelIndex at) {
  return {{at.x - 1, at.y, at.z}, {at.x + 1, at.y, at.z}, {at.x, at.y - 1, at.z},
          {at.x, at.y + 1, at.z}, {at.x, at.y, at.z - 1}, {at.x, at.y, at.z + 1}};
}

TEST(Navigation, FrontiersOfHalfATourCoverWhatIsFreedNext) {
  const Tour& tour = Tour::Get();
  const auto inflated = Inflate(tour.leaves[0], {kRadius, UnknownPolicy::kOccupied});
  const auto frontiers = FindFrontiers(tour.leaves[0], *inflated, {});
  ASSERT_TRUE(frontiers) << frontiers.error().message;
  std::set<VoxelIndex> left = FreedLeaves(tour.leaves[0], tour.leaves[1]);
  const size_t all = left.size();
  ASSERT_GT(all, 200u);
  // A leaf is covered when a way through freed leaves leads to it from a frontier.
  std::vector<VoxelIndex> reached;
  size_t with_viewpoint = 0;
  for (const Frontier& frontier : *frontiers) {
    reached.insert(reached.end(), frontier.leaves.begin(), frontier.leaves.end());
    with_viewpoint += frontier.viewpoint_W.has_value();
  }
  for (size_t next = 0; next < reached.size(); ++next) {
    for (const VoxelIndex& beside : BesideFaces(reached[next])) {
      if (left.erase(beside) > 0) reached.push_back(beside);
    }
  }
  const double covered = 1 - static_cast<double>(left.size()) / static_cast<double>(all);
  std::printf("%zu frontiers, %zu with a viewpoint; they cover %.1f %% of %zu leaves freed next\n",
              frontiers->size(), with_viewpoint, 100 * covered, all);
  EXPECT_GE(covered, 0.9);
  EXPECT_GT(with_viewpoint, 0u);
}

}  // namespace
}  // namespace vismap
