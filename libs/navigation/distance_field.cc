#include "navigation/distance_field.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/parallel.h"
#include "base/require.h"
#include "freespace/shortest_text.h"

namespace vismap {
namespace {

/// The distance that a field keeps [half leaves]: one leaf more than the limit, since a point can
/// be nearer to a site than the centre of its leaf is.
int KeptHalfLeaves(double leaf_m, double limit_m) {
  return static_cast<int>(std::ceil(2 * limit_m / leaf_m - 1e-6)) + 2;
}

VoxelBits UnknownIn(const OccupancyPlanes& planes) {
  VoxelBits unknown;
  for (size_t i = 0; i < unknown.size(); ++i) unknown[i] = ~(planes.free[i] | planes.occupied[i]);
  return unknown;
}

void CopyDistances(const SiteField& field, BlockIndex index, uint16_t most,
                   std::array<uint16_t, kBlockVoxels>* out) {
  const SiteField::Distances* values = field.Find(index);
  if (values == nullptr) return out->fill(field.outside_value());
  std::transform(values->begin(), values->end(), out->begin(),
                 [&](uint16_t value) { return value <= most ? value : kBeyond; });
}

}  // namespace

Result<DistanceField> DistanceField::Make(double leaf_m, const DistanceOptions& options) {
  Require(leaf_m > 0, "leaves have an edge of more than 0 m");
  const double most = std::round(kMostDistanceLeaves * leaf_m * 1e9) / 1e9;
  if (!(options.limit_m > 0 && options.limit_m <= most * (1 + 1e-9))) {
    return Fail("octomap_exporter.distance_limit_m: expected more than 0 and at most " +
                ShortestText(most) + " m with leaves of " + ShortestText(leaf_m) + " m, found " +
                ShortestText(options.limit_m) + " m");
  }
  return DistanceField(leaf_m, options);
}

DistanceField::DistanceField(double leaf_m, const DistanceOptions& options)
    : leaf_m_(leaf_m),
      limit_m_(options.limit_m),
      most_(static_cast<uint16_t>(std::pow(2 * options.limit_m / leaf_m, 2) + 1e-6)),
      obstacles_({KeptHalfLeaves(leaf_m, options.limit_m), false}),
      unknown_({KeptHalfLeaves(leaf_m, options.limit_m), true}) {}

std::vector<BlockIndex> DistanceField::Update(const OccupancyMap& leaves,
                                              std::span<const BlockIndex> changed) {
  Require(leaves.cell_size() == leaf_m_, "a DistanceField has one size of leaves");
  std::vector<SiteChange> obstacles, unknown;
  for (const BlockIndex& index : changed) {
    const BlockOccupancy& now = leaves.At(index);
    const BlockOccupancy* before = leaves_.Find(index);
    const bool known = !now.is(CellState::kUnknown);
    if (before == nullptr ? !known : *before == now) continue;
    const OccupancyPlanes planes = now.Planes();
    obstacles.push_back({index, planes.occupied, known});
    unknown.push_back({index, UnknownIn(planes), known});
    if (known) {
      leaves_.FindOrCreate(index) = now;
    } else {
      leaves_.Erase(index);
    }
  }
  std::array<std::vector<BlockIndex>, 2> parts;
  ParallelFor(2, 1, [&](size_t i) {
    parts[i] = i == 0 ? obstacles_.Update(obstacles) : unknown_.Update(unknown);
  });
  std::vector<BlockIndex> all;
  std::set_union(parts[0].begin(), parts[0].end(), parts[1].begin(), parts[1].end(),
                 std::back_inserter(all));
  return all;
}

std::optional<BlockDistances> DistanceField::At(BlockIndex index) const {
  if (leaves_.Find(index) == nullptr) return std::nullopt;
  BlockDistances distances;
  CopyDistances(obstacles_, index, most_, &distances.obstacle);
  CopyDistances(unknown_, index, most_, &distances.unknown);
  return distances;
}

// `p` in leaves.
bool DistanceField::InMap(const Eigen::Vector3d& p) const {
  if (!p.allFinite() || p.cwiseAbs().maxCoeff() > 1e9) return false;
  const auto leaf = [](double x) { return static_cast<int32_t>(std::floor(x)); };
  return leaves_.Find(BlockOf(VoxelIndex{leaf(p.x()), leaf(p.y()), leaf(p.z())})) != nullptr;
}

Clearance DistanceField::ClearanceFrom(const SiteField& field, NearestThing thing,
                                       const Eigen::Vector3d& p_W) const {
  const Eigen::Vector3d p = p_W / leaf_m_;
  if (!InMap(p)) return {0, Eigen::Vector3d::Zero(), NearestThing::kUnknown};
  const std::optional<NearestSite> found = field.Nearest(p, limit_m_ / leaf_m_);
  if (!found) return {limit_m_, Eigen::Vector3d::Zero(), NearestThing::kNone};
  Clearance clearance{found->distance * leaf_m_, Eigen::Vector3d::Zero(), thing};
  if (found->distance > 0) clearance.away_W = (p - found->at) / found->distance;
  return clearance;
}

Clearance DistanceField::FromObstacle(const Eigen::Vector3d& p_W) const {
  return ClearanceFrom(obstacles_, NearestThing::kObstacle, p_W);
}

Clearance DistanceField::FromUnknown(const Eigen::Vector3d& p_W) const {
  return ClearanceFrom(unknown_, NearestThing::kUnknown, p_W);
}

Clearance DistanceField::From(const Eigen::Vector3d& p_W) const {
  const Clearance obstacle = FromObstacle(p_W);
  if (obstacle.nearest != NearestThing::kNone && obstacle.distance_m == 0) return obstacle;
  const Clearance unknown = FromUnknown(p_W);
  return unknown.nearest != NearestThing::kNone && unknown.distance_m < obstacle.distance_m
             ? unknown
             : obstacle;
}

size_t DistanceField::bytes() const {
  return leaves_.bytes() + leaves_.size() * OccupancyMap::kMixedBytes + obstacles_.bytes() +
         unknown_.bytes();
}

}  // namespace vismap
