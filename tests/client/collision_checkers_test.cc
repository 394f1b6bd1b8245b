#include <dynamicEDT3D/dynamicEDTOctomap.h>
#include <fcl/fcl.h>
#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <sstream>
#include <vector>

#include "freespace/coarsen.h"
#include "freespace/octree.h"
#include "navigation/distance_field.h"
#include "support/recorded_map.h"

// What collision checkers of others say of our closed tree, beside our distances: FCL, with which
// most planners check, and DynamicEDT3D, the distances that come with OctoMap.

namespace vismap {
namespace {

constexpr double kRadius = 0.2;  // [m]
constexpr double kLeaf = 0.05;   // [m]
constexpr double kBeyond = 0.8;  // points are drawn so far outside of the bounds, too [m]
constexpr int kPoints = 2000;

struct MappedRoom {
  OccupancyMap leaves;
  Eigen::AlignedBox3d bounds_W;
  std::shared_ptr<octomap::OcTree> closed, raw;
};

std::shared_ptr<octomap::OcTree> ReadTree(const OctreeBytes& bytes) {
  std::istringstream stream(std::string(bytes.bytes.begin(), bytes.bytes.end()));
  auto tree = std::make_shared<octomap::OcTree>(bytes.resolution);
  EXPECT_TRUE(tree->readBinary(stream));
  return tree;
}

const MappedRoom& Room() {
  static const MappedRoom room = [] {
    VoxelGridOptions grid;
    grid.voxel_size_m = kLeaf / 2;
    OccupancyMap fine(grid.voxel_size_m);
    testing_support::MakeRecordedMap("synthetic:room?frames=16&width=160", 16, grid,
                                     [&](const SemanticMap& map, const MapDelta& delta) {
                                       fine.Update(map, delta.changed_blocks, {});
                                     });
    OctreeOptions options;
    options.resolution_m = kLeaf;
    const auto raw = BuildOctree(fine, options);
    options.unknown = UnknownPolicy::kOccupied;
    const auto closed = BuildOctree(fine, options);
    if (!raw || !closed) throw std::runtime_error("no octree of the room");
    return MappedRoom{Coarsen(fine, {2, options.free_fraction}), closed->bounds_W,
                      ReadTree(*closed), ReadTree(*raw)};
  }();
  return room;
}

std::vector<Eigen::Vector3d> RandomPoints(const Eigen::AlignedBox3d& box) {
  std::mt19937_64 random(3);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < kPoints; ++i) {
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis) {
      const double unit = static_cast<double>(random() >> 11) * 0x1p-53;
      p[axis] = box.min()[axis] + unit * box.sizes()[axis];
    }
    points.push_back(p);
  }
  return points;
}

DistanceField FieldOf(const OccupancyMap& leaves) {
  auto field = DistanceField::Make(kLeaf, {});
  if (!field) throw std::runtime_error(field.error().message);
  field->Update(leaves, leaves.SortedIndices());
  return std::move(*field);
}

class FclSpace {
 public:
  explicit FclSpace(const std::shared_ptr<octomap::OcTree>& tree)
      : object_(std::make_shared<fcl::OcTreed>(tree)) {}
  bool IsFree(const Eigen::Vector3d& p) const {
    const fcl::CollisionObjectd sphere(sphere_, Eigen::Matrix3d::Identity(), p);
    fcl::CollisionResultd result;
    return fcl::collide(&object_, &sphere, fcl::CollisionRequestd(), result) == 0;
  }

 private:
  fcl::CollisionObjectd object_;
  std::shared_ptr<fcl::Sphered> sphere_ = std::make_shared<fcl::Sphered>(kRadius);
};

TEST(CollisionCheckers, DistancesFindWhatFclFindsFreeOnTheClosedTreeAndNothingElse) {
  const MappedRoom& room = Room();
  const DistanceField field = FieldOf(room.leaves);
  const FclSpace fcl_space(room.closed);
  int free_by_fcl = 0, free_by_both = 0, only_by_distance = 0;
  const Eigen::Vector3d beyond = Eigen::Vector3d::Constant(kBeyond);
  for (const Eigen::Vector3d& p :
       RandomPoints({room.bounds_W.min() - beyond, room.bounds_W.max() + beyond})) {
    const bool by_fcl = fcl_space.IsFree(p);
    const bool by_distance = field.From(p).distance_m > kRadius;
    free_by_fcl += by_fcl;
    free_by_both += by_fcl && by_distance;
    only_by_distance += by_distance && !by_fcl;
  }
  RecordProperty("free_by_fcl", free_by_fcl);
  RecordProperty("free_by_both", free_by_both);
  EXPECT_GT(free_by_fcl, kPoints / 20);
  EXPECT_EQ(only_by_distance, 0);
  EXPECT_GE(free_by_both, 0.95 * free_by_fcl);
}

TEST(CollisionCheckers, DynamicEdtAgreesToHalfADiagonalAndFindsLessFreeWhenItIsSafe) {
  const MappedRoom& room = Room();
  const DistanceField field = FieldOf(room.leaves);
  const auto point = [](const Eigen::Vector3d& p) {
    return octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()),
                            static_cast<float>(p.z()));
  };
  DynamicEDTOctomap edt(1.0F, room.raw.get(), point(room.bounds_W.min()),
                        point(room.bounds_W.max()), true);
  edt.update();
  const double diagonal = std::sqrt(3.0) * kLeaf;
  int free_by_edt = 0, free_by_both = 0, free_by_distance = 0;
  // DynamicEDT3D knows nothing beyond the bounds, and calls it free.
  const Eigen::Vector3d inside = Eigen::Vector3d::Constant(0.5);
  for (const Eigen::Vector3d& p :
       RandomPoints({room.bounds_W.min() + inside, room.bounds_W.max() - inside})) {
    const Eigen::Vector3d centre =
        ((p / kLeaf).array().floor() + 0.5).matrix() * kLeaf;  // of the leaf
    const double theirs = edt.getDistance(point(centre));
    const double ours = field.From(centre).distance_m;
    if (theirs < 0.5) {
      EXPECT_LE(ours, theirs + 1e-6);
      EXPECT_GE(ours, theirs - diagonal / 2 - 1e-6);
    }
    const bool safe_by_edt = edt.getDistance(point(p)) > kRadius + diagonal;
    const bool by_distance = field.From(p).distance_m > kRadius;
    free_by_edt += safe_by_edt;
    free_by_distance += by_distance;
    free_by_both += safe_by_edt && by_distance;
  }
  RecordProperty("free_by_edt", free_by_edt);
  RecordProperty("free_by_distance", free_by_distance);
  EXPECT_GT(free_by_edt, kPoints / 20);
  EXPECT_EQ(free_by_both, free_by_edt);
  EXPECT_LT(free_by_edt, free_by_distance);
}

}  // namespace
}  // namespace vismap
