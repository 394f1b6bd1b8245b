// Free space beside OctoMap's own insertPointCloud on the same frames: leaves that are called free
// but reach into a surface, and what a planner meets that moves a sphere of 20 cm; also when the
// body of the robot, such a sphere around the camera, counts as free (start clearing), and with the
// best leaves of that size: free when all of a leaf was seen in truth, and no surface is in it.
//   free_space_bench [SCENE]
// SCENE: a folder of SceneNN, or a built-in sequence such as synthetic:office; only this one is
// measured then, else the built-in ones.
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>

#include "freespace/coarsen.h"
#include "support/planner_scenes.h"

namespace vismap {
namespace {

using testing_support::ClosedTreeOf;
using testing_support::FalseFree;
using testing_support::PlannerScene;
using testing_support::WithStartCleared;

constexpr int kStates = 20000;
constexpr double kRadius = 0.2, kWider = 0.8, kRange = 5;  // [m]

OccupancyMap LeavesOf(const SemanticMap& map, double resolution) {
  const int factor = static_cast<int>(std::lround(resolution / map.voxels.voxel_size()));
  return Coarsen(ClassifyMap(map, {}), {factor, 1.0});
}

/// The blocks of leaves that the usable ones of spheres touch.
std::set<BlockIndex> BlocksOfUsable(const testing_support::PlannerTruth& truth,
                                    const std::vector<Eigen::Vector3d>& centers, double leaf) {
  std::vector<char> usable(centers.size());
  ParallelFor(centers.size(), 64, [&](size_t i) {
    usable[i] = truth.distance(centers[i]) >= kRadius &&
                testing_support::IsAllSeen(truth, centers[i], kRadius, 0);
  });
  std::set<BlockIndex> blocks;
  for (size_t i = 0; i < centers.size(); ++i) {
    if (!usable[i]) continue;
    const double edge = leaf * kBlockSide;
    const Eigen::Array3i low = ((centers[i].array() - kRadius) / edge).floor().cast<int>();
    const Eigen::Array3i high = ((centers[i].array() + kRadius) / edge).floor().cast<int>();
    for (int x = low.x(); x <= high.x(); ++x) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int z = low.z(); z <= high.z(); ++z) blocks.insert({x, y, z});
      }
    }
  }
  return blocks;
}

/// Whether all of a leaf was seen by some frame, and no surface is in it.
bool IsTrulyFree(const testing_support::PlannerTruth& truth, const Eigen::Vector3d& corner,
                 double leaf) {
  constexpr int kSamples = 4;  // along each edge
  for (int i = 0; i < kSamples * kSamples * kSamples; ++i) {
    const Eigen::Vector3d at(i % kSamples, i / kSamples % kSamples, i / kSamples / kSamples);
    const Eigen::Vector3d p = corner + leaf / (kSamples - 1) * at;
    if (truth.distance(p) <= 0.005 || !truth.seen.Contains(p, 0)) return false;
  }
  return true;
}

/// The best that a tree with such leaves can say without calling free what was not seen.
OccupancyMap BestLeaves(const testing_support::PlannerTruth& truth,
                        const Eigen::AlignedBox3d& bounds_W, double leaf) {
  const std::set<BlockIndex> blocks =
      BlocksOfUsable(truth, testing_support::DrawCenters(bounds_W, kStates), leaf);
  const std::vector<BlockIndex> indices(blocks.begin(), blocks.end());
  std::vector<OccupancyPlanes> planes(indices.size());
  ParallelFor(indices.size(), 1, [&](size_t block) {
    for (int i = 0; i < kBlockVoxels; ++i) {
      const BlockIndex& index = indices[block];
      const Eigen::Vector3d corner =
          leaf * Eigen::Vector3d(kBlockSide * index.x + i % 8, kBlockSide * index.y + i / 8 % 8,
                                 kBlockSide * index.z + i / 64);
      if (IsTrulyFree(truth, corner, leaf))
        planes[block].free[static_cast<size_t>(i) / 64] |= uint64_t{1} << (i % 64);
    }
  });
  OccupancyMap leaves(leaf);
  for (size_t i = 0; i < indices.size(); ++i) leaves.Set(indices[i], BlockOccupancy(planes[i]));
  return leaves;
}

/// The points of a frame, every second pixel each way.
octomap::Pointcloud PointsOf(const RgbdFrame& frame) {
  octomap::Pointcloud points;
  for (int v = 0; v < frame.depth.height(); v += 2) {
    for (int u = 0; u < frame.depth.width(); u += 2) {
      const double z = double{frame.depth(v, u)};
      if (!(z > 0.1 && z < 10)) continue;
      const Eigen::Vector3d p_W = frame.header.T_W_C * frame.header.camera.BackProject(u, v, z);
      points.push_back(static_cast<float>(p_W.x()), static_cast<float>(p_W.y()),
                       static_cast<float>(p_W.z()));
    }
  }
  return points;
}

std::unique_ptr<octomap::OcTree> OctomapTree(const Dataset& dataset, double resolution) {
  auto tree = std::make_unique<octomap::OcTree>(resolution);
  Rectifier rectifier;
  for (size_t i = 0; i < dataset.size(); ++i) {
    const auto frame = rectifier.Decode(*dataset.Read(i));
    const Eigen::Vector3d eye = frame->header.T_W_C.translation();
    const octomap::point3d origin(static_cast<float>(eye.x()), static_cast<float>(eye.y()),
                                  static_cast<float>(eye.z()));
    tree->insertPointCloud(PointsOf(*frame), origin, kRange, true, true);
  }
  tree->updateInnerOccupancy();
  return tree;
}

/// Where only points of the surface are known, a leaf is false when one of them lies in it, and
/// reaches as deep as the point is from the nearest face of the leaf.
FalseFree CountPoints(const octomap::OcTree& tree, const GroundTruth& truth) {
  FalseFree result;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (tree.isNodeOccupied(*leaf)) continue;
    const auto side = static_cast<int64_t>(std::lround(leaf.getSize() / tree.getResolution()));
    result.free += side * side * side;
  }
  const double r = tree.getResolution();
  std::map<std::array<int, 3>, double> deepest;
  for (const Eigen::Vector3f& point : truth.points_W) {
    const octomap::OcTreeNode* node = tree.search(point.x(), point.y(), point.z());
    if (node == nullptr || tree.isNodeOccupied(node)) continue;
    const Eigen::Array3d p = point.cast<double>().array() / r;
    const Eigen::Array3d low = p.floor();
    const double depth = r * (p - low).min(low + 1 - p).minCoeff();
    double& most =
        deepest[{static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(low.z())}];
    most = std::max(most, depth);
  }
  for (const auto& [cell, depth] : deepest) {
    result.cells += depth > 0.001 ? 1 : 0;
    result.worst = std::max(result.worst, depth);
  }
  return result;
}

void Compare(PlannerScene scene, const std::optional<GroundTruth>& points) {
  MapSession session({}, {});
  testing_support::MapFrames(*scene.dataset, {}, SIZE_MAX, &session);
  std::optional<Eigen::AlignedBox3d> bounds;
  const auto tell = [&](const std::string& name, const octomap::OcTree& tree) {
    if (!bounds) bounds = testing_support::Wider(testing_support::BoundsOfFree(tree), kWider);
    Print(name,
          points ? CountPoints(tree, *points)
                 : testing_support::CountFalseFree(tree, scene.signed_distance),
          testing_support::ScoreStates(tree, scene.truth, *bounds, kStates, kRadius,
                                       testing_support::AbsentLeaves::kOccupied));
    std::fflush(stdout);
  };
  std::printf("%s\n", scene.name.c_str());
  constexpr double kResolutions[] = {0.04, 0.05, 0.1};
  const auto size_text = [](double resolution) {
    return std::to_string(std::lround(100 * resolution)) + " cm";
  };
  for (const double resolution : kResolutions) {
    const std::string size = size_text(resolution);
    tell("  vismap, closed, " + size,
         *ClosedTreeOf(LeavesOf(session.map(), resolution), resolution));
    tell("  OctoMap, " + size, *OctomapTree(*scene.dataset, resolution));
  }
  tell("  vismap, closed, 2 cm", *ClosedTreeOf(LeavesOf(session.map(), 0.02), 0.02));
  for (const double resolution : kResolutions) {
    tell("  best, " + size_text(resolution),
         *ClosedTreeOf(BestLeaves(scene.truth, *bounds, resolution), resolution));
  }
  const std::vector<Eigen::Vector3d> path_W = testing_support::PathOf(*scene.dataset);
  for (const double resolution : kResolutions) {
    scene.truth.seen.AddBody(path_W, kRadius, 2 * std::sqrt(3) * resolution);
    tell("  with start clearing, " + size_text(resolution),
         *ClosedTreeOf(WithStartCleared(LeavesOf(session.map(), resolution), kRadius, path_W),
                       resolution));
  }
}

}  // namespace
}  // namespace vismap

namespace {

using namespace vismap;
using namespace vismap::testing_support;

int Refuse(const std::string& why) {
  std::fprintf(stderr, "free_space_bench: %s\n", why.c_str());
  return 2;
}

int CompareScene(const std::string& path) {
  if (path.starts_with("synthetic:")) {
    const auto options = ParseSyntheticPath(path);
    if (!options) return Refuse(options.error().message);
    Compare(SyntheticPlannerScene(path), std::nullopt);
    return 0;
  }
  const Result<GroundTruth> truth = ReadSceneNnTruth(path);
  if (!truth) return Refuse(truth.error().message);
  const auto sequence = OpenSequence(path, "", {});
  if (!sequence) return Refuse(sequence.error().message);
  Compare(RecordedPlannerScene(path), *truth);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) return CompareScene(argv[1]);
  for (const char* room :
       {"synthetic:room?frames=80", "synthetic:room?frames=80&pose_noise=0.02"}) {
    PlannerScene scene = SyntheticPlannerScene(room);
    if (std::string(room).find("pose_noise") != std::string::npos) scene.truth.tolerance = 0.1;
    Compare(std::move(scene), std::nullopt);
  }
  Compare(HallPlannerScene(), std::nullopt);
  return 0;
}
