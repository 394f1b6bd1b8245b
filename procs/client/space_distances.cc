#include <stdexcept>

#include "client/navigation.h"
#include "navigation/distance_field.h"
#include "navigation/tree_leaves.h"

namespace vismap {
namespace {

SpaceDistance ToSpaceDistance(const Clearance& clearance) {
  using Nearest = SpaceDistance::Nearest;
  SpaceDistance distance;
  distance.distance_m = clearance.distance_m;
  for (size_t axis = 0; axis < 3; ++axis)
    distance.away_W[axis] = clearance.away_W[static_cast<Eigen::Index>(axis)];
  if (clearance.nearest == NearestThing::kObstacle) distance.nearest = Nearest::kObstacle;
  if (clearance.nearest == NearestThing::kUnknown) distance.nearest = Nearest::kUnknown;
  return distance;
}

Eigen::Vector3d ToVector(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

DistanceField MakeField(const octree_t& tree, double limit_m) {
  const auto leaves = ReadTreeLeaves(tree.data, "octree_t of map '" + tree.map_id + "'");
  if (!leaves) throw std::invalid_argument(leaves.error().message);
  auto field = DistanceField::Make(leaves->cell_size(), {.limit_m = limit_m});
  if (!field) throw std::invalid_argument(field.error().message);
  field->Update(*leaves, leaves->SortedIndices());
  return std::move(*field);
}

}  // namespace

struct SpaceDistances::Field {
  DistanceField distances;
};

SpaceDistances::SpaceDistances(const octree_t& tree, double limit_m)
    : field_(std::make_unique<Field>(Field{MakeField(tree, limit_m)})) {}
SpaceDistances::~SpaceDistances() = default;
SpaceDistances::SpaceDistances(SpaceDistances&&) noexcept = default;
SpaceDistances& SpaceDistances::operator=(SpaceDistances&&) noexcept = default;

SpaceDistance SpaceDistances::FromObstacle(const std::array<double, 3>& p_W) const {
  return ToSpaceDistance(field_->distances.FromObstacle(ToVector(p_W)));
}
SpaceDistance SpaceDistances::FromUnknown(const std::array<double, 3>& p_W) const {
  return ToSpaceDistance(field_->distances.FromUnknown(ToVector(p_W)));
}
SpaceDistance SpaceDistances::From(const std::array<double, 3>& p_W) const {
  return ToSpaceDistance(field_->distances.From(ToVector(p_W)));
}

}  // namespace vismap
