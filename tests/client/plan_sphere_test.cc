#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/octomap.h>
#include <signal.h>

#include <deque>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "client/fake_exporter.h"
#include "client/navigation.h"
#include "navigation/inflate.h"
#include "process/room_pipeline.h"
#include "simulation/room.h"

// The example plan_sphere (OMPL, FCL), and all of vismap's processes before it.

namespace vismap {
namespace {

using ::testing::HasSubstr;
using testing_support::FakeExporter;
using testing_support::TwoRooms;

constexpr double kRadius = 0.2;  // [m]

std::string PointText(const Eigen::Vector3d& p) {
  std::ostringstream text;
  text << p.x() << "," << p.y() << "," << p.z();
  return text.str();
}

class PlanSphereTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kProgram))
      GTEST_SKIP() << "plan_sphere was not built, since OMPL or FCL is missing";
  }
  std::unique_ptr<ChildProcess> Plan(const Eigen::Vector3d& start, const Eigen::Vector3d& goal,
                                     const std::string& seconds) {
    return std::make_unique<ChildProcess>(
        kProgram,
        std::vector<std::string>{PointText(start), PointText(goal), std::to_string(kRadius),
                                 seconds, processes.url()},
        processes.folder());
  }

  static constexpr char kProgram[] = VISMAP_EXAMPLES_DIR "/plan_sphere";
  ProcessBus processes;
};

std::vector<Eigen::Vector3d> PathOf(const std::string& output) {
  std::vector<Eigen::Vector3d> path;
  std::istringstream lines(output);
  for (Eigen::Vector3d p; lines >> p.x() >> p.y() >> p.z();) path.push_back(p);
  return path;
}

TEST_F(PlanSphereTest, GoesThroughKnownSpaceOnlyAndSaysWhyNot) {
  FakeExporter exporter(&processes);
  const Eigen::Vector3d here(0.5, 0.5, 0.8), there(3.1, 0.8, 0.8);
  const auto run = [&](const Eigen::Vector3d& start, const Eigen::Vector3d& goal) {
    auto program = Plan(start, goal, "1");
    EXPECT_TRUE(exporter.LiveUntil([&] { return !program->Running(); }));
    return program;
  };
  exporter.SetMap(TwoRooms(true), 1);
  const auto open = run(here, there);
  EXPECT_EQ(open->WaitForExit(), 0) << open->StandardError();
  const auto path = PathOf(open->StandardOutput());
  ASSERT_GE(path.size(), 2u);
  EXPECT_LT((path.front() - here).norm(), 1e-3);
  EXPECT_LT((path.back() - there).norm(), 1e-3);

  exporter.SetMap(TwoRooms(false), 2);
  const auto expect_refusal = [&](const Eigen::Vector3d& start, const Eigen::Vector3d& goal,
                                  const std::string& words) {
    const auto program = run(start, goal);
    EXPECT_EQ(program->WaitForExit(), 1);
    EXPECT_THAT(program->StandardError(), HasSubstr(words));
    EXPECT_EQ(program->StandardOutput(), "");
  };
  expect_refusal(here, there, "no path through free space was found");
  expect_refusal({1, 1, 0.8}, here, "the start (1.00, 1.00, 0.80) is in an obstacle");
  expect_refusal({0.7, 1, 0.8}, here,
                 "is 0.10 m from an obstacle, nearer than the radius of 0.20 m");
  expect_refusal(here, {1.8, 0.8, 0.8}, "the goal (1.80, 0.80, 0.80) is in unknown space");
  expect_refusal(here, {0.5, 0.15, 0.8}, "is 0.15 m from unknown space");
  expect_refusal({0.5, 0.15, 0.8}, here, "see octomap_exporter.clear_start_m in the config");
  expect_refusal(here, {0.5, -0.8, 0.8}, "is outside of the known space, which is from (0.00");
}

TEST_F(PlanSphereTest, FindsTheMapUnderAPrefix) {
  ProcessBus prefixed(processes, "robot1/");
  FakeExporter exporter(&prefixed);
  exporter.SetMap(TwoRooms(true), 1);
  ChildProcess program(
      kProgram,
      {"--channel-prefix", "robot1/", "0.5,0.5,0.8", "3.1,0.8,0.8", "0.2", "1", processes.url()},
      processes.folder());
  ASSERT_TRUE(exporter.LiveUntil([&] { return !program.Running(); }));
  EXPECT_EQ(program.WaitForExit(), 0) << program.StandardError();
  EXPECT_GE(PathOf(program.StandardOutput()).size(), 2u);
  ChildProcess wrong(kProgram, {"0,0,0", "1,1,1", "--channel-prefix"}, processes.folder());
  EXPECT_EQ(wrong.WaitForExit(), 2);
}

/// The leaves of a tree that OctoMap has read.
OccupancyMap LeavesOf(const octree_t& message) {
  std::istringstream stream(std::string(message.data.begin(), message.data.end()));
  octomap::OcTree tree(message.resolution_m);
  EXPECT_TRUE(tree.readBinary(stream));
  tree.expand();
  std::map<BlockIndex, OccupancyPlanes> planes;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const auto index = [&](unsigned axis) { return static_cast<int>(leaf.getKey()[axis]) - 32768; };
    const VoxelIndex cell{index(0), index(1), index(2)};
    OccupancyPlanes& block = planes[BlockOf(cell)];
    const size_t offset = OffsetInBlock(cell);
    auto& bits = tree.isNodeOccupied(*leaf) ? block.occupied : block.free;
    bits[offset / 64] |= uint64_t{1} << (offset % 64);
  }
  OccupancyMap leaves(message.resolution_m);
  for (const auto& [index, block] : planes) leaves.Set(index, BlockOccupancy(block));
  return leaves;
}

Eigen::Vector3d CentreOf(const VoxelIndex& leaf, double edge) {
  return (Eigen::Vector3d(leaf.x, leaf.y, leaf.z) + Eigen::Vector3d::Constant(0.5)) * edge;
}

std::vector<VoxelIndex> CellsWith(CellState state, const OccupancyMap& leaves) {
  std::vector<VoxelIndex> cells;
  const OccupancyBox box = *leaves.KnownCells();
  for (int z = box.min.z; z < box.max.z; ++z) {
    for (int y = box.min.y; y < box.max.y; ++y) {
      for (int x = box.min.x; x < box.max.x; ++x) {
        if (leaves.At(VoxelIndex{x, y, z}) == state) cells.push_back({x, y, z});
      }
    }
  }
  return cells;
}

/// Free cells that can be reached from `start` over faces, the farthest last.
std::vector<VoxelIndex> ReachableFrom(const VoxelIndex& start, const OccupancyMap& leaves) {
  std::vector<VoxelIndex> reached{start};
  std::set<std::tuple<int, int, int>> seen{{start.x, start.y, start.z}};
  for (size_t i = 0; i < reached.size(); ++i) {
    for (const VoxelIndex step :
         {VoxelIndex{1, 0, 0}, VoxelIndex{-1, 0, 0}, VoxelIndex{0, 1, 0}, VoxelIndex{0, -1, 0},
          VoxelIndex{0, 0, 1}, VoxelIndex{0, 0, -1}}) {
      const VoxelIndex next{reached[i].x + step.x, reached[i].y + step.y, reached[i].z + step.z};
      if (leaves.At(next) == CellState::kFree && seen.insert({next.x, next.y, next.z}).second)
        reached.push_back(next);
    }
  }
  return reached;
}

/// Of all free cells, two that are connected and far from each other.
std::pair<VoxelIndex, VoxelIndex> FarPair(const OccupancyMap& leaves) {
  std::vector<VoxelIndex> largest;
  std::set<std::tuple<int, int, int>> seen;
  for (const VoxelIndex& cell : CellsWith(CellState::kFree, leaves)) {
    if (seen.contains({cell.x, cell.y, cell.z})) continue;
    std::vector<VoxelIndex> reached = ReachableFrom(cell, leaves);
    for (const VoxelIndex& other : reached) seen.insert({other.x, other.y, other.z});
    if (reached.size() > largest.size()) largest = std::move(reached);
  }
  if (largest.empty()) throw std::runtime_error("the robot fits nowhere");
  const VoxelIndex from = largest.back();
  return {from, ReachableFrom(from, leaves).back()};
}

class RoomPlanningTest : public PlanSphereTest {
 protected:
  RoomPlanningTest() : pipeline(&processes) { pipeline.detections = "none"; }

  void MapTheRoom() {
    pipeline.Start();
    NavigationClientOptions options;
    options.url = processes.url();
    options.name = "test planner";
    options.trees = {TreeKind::kClosed, TreeKind::kRaw, TreeKind::kInflated};
    client = std::make_unique<NavigationClient>(options);
    client->Start();
    pipeline.WaitForEnd();
    ExpectExporterIsLevel(&processes);
    ASSERT_TRUE(processes.SpinUntil([&] {
      return IsLevel(TreeKind::kClosed) && IsLevel(TreeKind::kRaw) && IsLevel(TreeKind::kInflated);
    }));
  }
  bool IsLevel(TreeKind kind) {
    const FreeSpace space = client->Newest(kind);
    return !space.stale && space.tree->revision == RoomPipeline::kFrames;
  }
  std::unique_ptr<ChildProcess> Run(const Eigen::Vector3d& start, const Eigen::Vector3d& goal) {
    auto program = Plan(start, goal, "5");
    EXPECT_TRUE(processes.SpinUntil([&] { return !program->Running(); }));
    return program;
  }
  void ExpectRefusal(const Eigen::Vector3d& start, const Eigen::Vector3d& goal,
                     const std::string& words) {
    const auto refused = Run(start, goal);
    EXPECT_EQ(refused->WaitForExit(), 1);
    EXPECT_THAT(refused->StandardError(), HasSubstr(words));
  }
  /// How long after the death of a program the client still took the tree for the newest [s].
  double SecondsUntilStale(ChildProcess* program) {
    Crash(program);
    const double start = MonotonicSeconds();
    EXPECT_TRUE(processes.SpinUntil([&] { return client->Newest(TreeKind::kClosed).stale; }));
    return MonotonicSeconds() - start;
  }

  RoomPipeline pipeline;
  std::unique_ptr<NavigationClient> client;
};

/// Every point of the path keeps the radius to the true surfaces, and lies in seen space.
void ExpectSafe(const std::vector<Eigen::Vector3d>& path, const OccupancyMap& seen) {
  ASSERT_GE(path.size(), 2u);
  const Scene room = MakeRoom();
  double clearance = std::numeric_limits<double>::infinity();
  for (size_t i = 1; i < path.size(); ++i) {
    const double length = (path[i] - path[i - 1]).norm();
    for (double s = 0; s <= length; s += 0.005) {
      const Eigen::Vector3d p = path[i - 1] + (path[i] - path[i - 1]) * s / std::max(length, 1e-9);
      clearance = std::min(clearance, SignedDistance(room, p));
      EXPECT_EQ(seen.At(p), CellState::kFree) << p.transpose();
    }
  }
  EXPECT_GE(clearance, kRadius);
  ::testing::Test::RecordProperty("clearance", std::to_string(clearance));
}

/// The inflated tree, published or asked for, is free where the leaves of the raw one inflated here
/// are, and nowhere else.
void ExpectFreeAlike(const FreeSpace& space, const OccupancyMap& inflated) {
  ASSERT_TRUE(space) << space.why;
  EXPECT_EQ(space.tree->inflated_by_m, kRadius);
  const OccupancyMap theirs = LeavesOf(*space.tree);
  const std::vector<VoxelIndex> free = CellsWith(CellState::kFree, theirs);
  EXPECT_GT(free.size(), 1000u);
  for (const VoxelIndex& cell : free) ASSERT_EQ(inflated.At(cell), CellState::kFree);
  EXPECT_EQ(free.size(), CellsWith(CellState::kFree, inflated).size());
}

TEST_F(RoomPlanningTest, PlansSafelyThroughTheMappedRoomAndKnowsWhatHasDied) {
  ASSERT_NO_FATAL_FAILURE(MapTheRoom());
  const FreeSpace raw = client->Newest(TreeKind::kRaw);
  const OccupancyMap seen = LeavesOf(*raw.tree);
  const auto inflated = Inflate(seen, {kRadius, UnknownPolicy::kOccupied});
  ASSERT_TRUE(inflated) << inflated.error().message;
  ExpectFreeAlike(client->Newest(TreeKind::kInflated), *inflated);
  TreeRequest request;
  request.inflate_m = kRadius;
  ExpectFreeAlike(client->AskTree(request, kProcessDeadline), *inflated);
  request.resolution_m = 0.033;
  EXPECT_THAT(client->AskTree(request, kProcessDeadline).why, HasSubstr("0.033"));
  const auto [from, to] = FarPair(*inflated);
  const double leaf = seen.cell_size();
  const Eigen::Vector3d start = CentreOf(from, leaf), goal = CentreOf(to, leaf);
  EXPECT_GT((goal - start).norm(), 1.5);

  const auto program = Run(start, goal);
  ASSERT_EQ(program->WaitForExit(), 0) << program->StandardError();
  const std::vector<Eigen::Vector3d> path = PathOf(program->StandardOutput());
  ExpectSafe(path, seen);
  EXPECT_LT((path.back() - goal).norm(), 1e-3);

  const Eigen::Vector3d unseen = CentreOf(CellsWith(CellState::kUnknown, seen).front(), leaf);
  ExpectRefusal(start, unseen, "the goal ");
  const Eigen::Vector3d beyond(raw.tree->bbx_max_W[0] + 0.8, goal.y(), goal.z());
  ExpectRefusal(start, beyond, "is outside of the known space");

  EXPECT_LT(SecondsUntilStale(pipeline.exporter.get()), 3);
  EXPECT_THAT(client->Newest(TreeKind::kClosed).why,
              HasSubstr("the octomap exporter was not heard"));
  ExpectRefusal(start, goal, "exporter");
  pipeline.StartExporter();
  ASSERT_TRUE(processes.SpinUntil([&] { return IsLevel(TreeKind::kClosed); }));
  EXPECT_LT(SecondsUntilStale(pipeline.server.get()), 3);
  EXPECT_THAT(client->Newest(TreeKind::kClosed).why, HasSubstr("the map server was not heard"));
}

}  // namespace
}  // namespace vismap
