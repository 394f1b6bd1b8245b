#include "objects/structure.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "objects/label_surfaces.h"
#include "objects/oriented_box.h"

namespace vismap {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

bool IsLevel(const SurfacePlane& plane, const Eigen::Vector3d& up_W,
             const StructureOptions& options) {
  return std::abs(plane.normal_W.dot(up_W)) >= std::cos(options.max_tilt_deg * kDegree);
}

bool IsUpright(const SurfacePlane& plane, const Eigen::Vector3d& up_W,
               const StructureOptions& options) {
  return std::abs(plane.normal_W.dot(up_W)) <= std::sin(options.max_tilt_deg * kDegree);
}

bool IsLarge(const SurfacePlane& plane, const StructureOptions& options) {
  return std::max(plane.area, plane.joint_area) >= options.structure_area_m2 &&
         plane.share >= options.structure_share;
}

StructureKind KindOf(const SurfacePlane& plane, const Eigen::Vector3d& up_W, double floor,
                     const StructureOptions& options) {
  const bool large = IsLarge(plane, options);
  if (!IsLevel(plane, up_W, options)) {
    if (!large) return StructureKind::kNone;  // too small for a wall or a slope
    return IsUpright(plane, up_W, options) ? StructureKind::kWall : StructureKind::kSloped;
  }
  const double height = plane.point_W.dot(up_W) - floor;
  if (height >= options.table_low_m && height <= options.table_high_m) {
    const bool top = plane.area >= options.table_area_m2 && plane.share >= options.table_share;
    return top ? StructureKind::kTableTop : StructureKind::kNone;
  }
  if (!large) return StructureKind::kNone;
  if (height < options.table_low_m) return StructureKind::kFloor;
  return height >= options.ceiling_low_m ? StructureKind::kCeiling : StructureKind::kSloped;
}

// Whether a flat, level piece is at the height of a floor: small pieces of floor between objects
// are floor, too.
bool IsPieceOfFloor(const SurfacePlane& bit, std::span<const SurfacePlane> planes,
                    std::span<const StructureKind> kinds, const Eigen::Vector3d& up_W,
                    const StructureOptions& options) {
  if (bit.share < options.structure_share || !IsLevel(bit, up_W, options)) return false;
  for (size_t i = 0; i < planes.size(); ++i) {
    const double above = (bit.point_W - planes[i].point_W).dot(up_W);
    if (kinds[i] == StructureKind::kFloor && std::abs(above) <= options.structure_flatness_m)
      return true;
  }
  return false;
}

// Mean square distance of the points of a piece from a plane [m^2].
double MeanSquareFrom(const SurfacePlane& plane, const SurfaceSpread& piece) {
  const double off = (piece.mean_W - plane.point_W).dot(plane.normal_W);
  return plane.normal_W.dot(piece.covariance_W * plane.normal_W) + off * off;
}

// The distance of a piece from a plane, divided by the largest distance of a flush piece.
double FlushDistance(const SurfacePlane& plane, const SurfaceSpread& piece,
                     const StructureOptions& options) {
  // The roughness counts as at least this share of the flatness. Exact depth has no noise at all,
  // and without this limit, no piece would be flush with such a plane.
  constexpr double kLeast = 0.1;
  const double roughness = std::max(plane.roughness, kLeast * options.structure_flatness_m);
  return std::sqrt(MeanSquareFrom(plane, piece)) / (options.flush_roughness * roughness);
}

bool IsFlush(const SurfacePlane& plane, const SurfaceSpread& own, const SurfaceSpread& piece,
             const StructureOptions& options) {
  return FlushDistance(plane, piece, options) < 1 &&
         own.bounds_W.exteriorDistance(piece.bounds_W) <= options.flush_gap_m;
}

// Flat objects lie on table tops, so nothing is joined to those.
bool AcceptsFlushPieces(StructureKind kind) {
  return kind != StructureKind::kNone && kind != StructureKind::kTableTop;
}

}  // namespace

const char* NameOf(StructureKind kind) {
  switch (kind) {
    case StructureKind::kNone:
      return "none";
    case StructureKind::kFloor:
      return "floor";
    case StructureKind::kTableTop:
      return "table_top";
    case StructureKind::kCeiling:
      return "ceiling";
    case StructureKind::kWall:
      return "wall";
    case StructureKind::kSloped:
      return "sloped";
  }
  return "none";
}

SurfacePlane FindPlane(std::span<const Eigen::Vector3f> points_W, double area,
                       const StructureOptions& options) {
  if (points_W.empty()) return {};
  constexpr size_t kMostPoints = 4000;
  const size_t stride = (points_W.size() + kMostPoints - 1) / kMostPoints;
  std::vector<Eigen::Vector3f> picked;
  for (size_t i = 0; i < points_W.size(); i += stride) picked.push_back(points_W[i]);
  const PlaneFit fit = FitPlane(picked, options.structure_flatness_m);
  return {fit.point_W, fit.normal_W, fit.inliers, fit.inliers * area, fit.roughness};
}

std::vector<StructureKind> NameStructure(std::span<const SurfacePlane> planes,
                                         const Eigen::Vector3d& up_W, double lowest,
                                         const StructureOptions& options) {
  double floor = std::numeric_limits<double>::infinity();
  for (const SurfacePlane& plane : planes) {
    if (IsLarge(plane, options) && IsLevel(plane, up_W, options))
      floor = std::min(floor, plane.point_W.dot(up_W));
  }
  if (!std::isfinite(floor)) floor = lowest;
  std::vector<StructureKind> kinds;
  for (const SurfacePlane& plane : planes) {
    kinds.push_back(plane.area > 0 ? KindOf(plane, up_W, floor, options) : StructureKind::kNone);
  }
  const std::vector<StructureKind> large = kinds;
  for (size_t i = 0; i < planes.size(); ++i) {
    if (large[i] == StructureKind::kNone && IsPieceOfFloor(planes[i], planes, large, up_W, options))
      kinds[i] = StructureKind::kFloor;
  }
  return kinds;
}

SurfaceSpread SpreadOf(std::span<const Eigen::Vector3f> points_W) {
  SurfaceSpread spread;
  if (points_W.empty()) return spread;
  for (const Eigen::Vector3f& p : points_W) {
    spread.mean_W += p.cast<double>();
    spread.bounds_W.extend(p.cast<double>());
  }
  spread.mean_W /= static_cast<double>(points_W.size());
  for (const Eigen::Vector3f& p : points_W) {
    const Eigen::Vector3d d = p.cast<double>() - spread.mean_W;
    spread.covariance_W += d * d.transpose();
  }
  spread.covariance_W /= static_cast<double>(points_W.size());
  return spread;
}

double SpannedArea(const SurfaceSpread& spread) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread.covariance_W,
                                                              Eigen::EigenvaluesOnly);
  const Eigen::Vector3d variances = solver.eigenvalues().cwiseMax(0);  // ascending
  // Points that are evenly spread over a length a have the variance a^2 / 12.
  return 12 * std::sqrt(variances[1] * variances[2]);
}

void JoinFlushAreas(std::span<const SurfaceSpread> spreads, const StructureOptions& options,
                    std::vector<SurfacePlane>* planes) {
  std::vector<size_t> flat;
  for (size_t i = 0; i < planes->size(); ++i) {
    SurfacePlane& plane = (*planes)[i];
    plane.joint_area = 0;
    if (plane.area > 0 && plane.share >= options.structure_share && options.flush_roughness > 0)
      flat.push_back(i);
  }
  for (const size_t i : flat) {
    double joint_area = (*planes)[i].area;
    for (const size_t j : flat) {
      if (i == j) continue;
      const auto [less, more] =
          (*planes)[i].area < (*planes)[j].area ? std::pair(i, j) : std::pair(j, i);
      if (IsFlush((*planes)[more], spreads[more], spreads[less], options))
        joint_area += (*planes)[j].area;
    }
    (*planes)[i].joint_area = joint_area;
  }
}

void NameFlushPieces(std::span<const SurfacePlane> planes, std::span<const SurfaceSpread> spreads,
                     const StructureOptions& options, std::vector<StructureKind>* kinds) {
  if (options.flush_roughness <= 0) return;
  const std::vector<StructureKind> known = *kinds;
  for (size_t i = 0; i < known.size(); ++i) {
    if (known[i] != StructureKind::kNone || spreads[i].bounds_W.isEmpty()) continue;
    double closest = 1;
    for (size_t j = 0; j < known.size(); ++j) {
      if (!AcceptsFlushPieces(known[j])) continue;  // no structure, or a table top
      const double distance = FlushDistance(planes[j], spreads[i], options);
      if (distance >= closest) continue;  // not flush, or another plane is nearer
      if (spreads[i].bounds_W.exteriorDistance(spreads[j].bounds_W) > options.flush_gap_m) continue;
      closest = distance;
      (*kinds)[i] = known[j];
    }
  }
}

Eigen::Vector3d RefineUp(const Eigen::Vector3d& up_W, const LabelSurfaces& surfaces,
                         const StructureOptions& options) {
  SurfacePlane best;
  for (const LabelSurface& surface : surfaces) {
    if (surface.area < options.structure_area_m2 || surface.area <= best.area) continue;
    const SurfacePlane plane = FindPlane(surface.points_W, surface.area, options);
    if (IsLarge(plane, options) && plane.area > best.area &&
        std::abs(plane.normal_W.dot(up_W)) > std::cos(30 * kDegree))
      best = plane;
  }
  const double along = best.normal_W.dot(up_W);
  if (best.area == 0 || std::abs(along) > std::cos(3 * kDegree)) return up_W;
  return along > 0 ? best.normal_W : Eigen::Vector3d(-best.normal_W);
}

}  // namespace vismap
