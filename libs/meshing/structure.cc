#include "meshing/structure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "meshing/label_surfaces.h"
#include "meshing/oriented_box.h"

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
  return plane.area >= options.area && plane.share >= options.share;
}

StructureKind KindOf(const SurfacePlane& plane, const Eigen::Vector3d& up_W, double floor,
                     const StructureOptions& options) {
  const bool large = IsLarge(plane, options);
  if (!IsLevel(plane, up_W, options)) {
    if (!large) return StructureKind::kNone;
    return IsUpright(plane, up_W, options) ? StructureKind::kWall : StructureKind::kSloped;
  }
  const double height = plane.point_W.dot(up_W) - floor;
  if (height >= options.table_low && height <= options.table_high) {
    const bool top = plane.area >= options.table_area && plane.share >= options.table_share;
    return top ? StructureKind::kTableTop : StructureKind::kNone;
  }
  if (!large) return StructureKind::kNone;
  if (height < options.table_low) return StructureKind::kFloor;
  return height >= options.ceiling_low ? StructureKind::kCeiling : StructureKind::kSloped;
}

// Bits of floor between things are floor, too, however small.
bool IsBitOfFloor(const SurfacePlane& bit, std::span<const SurfacePlane> planes,
                  std::span<const StructureKind> kinds, const Eigen::Vector3d& up_W,
                  const StructureOptions& options) {
  if (bit.share < options.share || !IsLevel(bit, up_W, options)) return false;
  for (size_t i = 0; i < planes.size(); ++i) {
    const double above = (bit.point_W - planes[i].point_W).dot(up_W);
    if (kinds[i] == StructureKind::kFloor && std::abs(above) <= options.flatness) return true;
  }
  return false;
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
  const PlaneFit fit = FitPlane(picked, options.flatness);
  return {fit.point_W, fit.normal_W, fit.inliers, fit.inliers * area};
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
    if (large[i] == StructureKind::kNone && IsBitOfFloor(planes[i], planes, large, up_W, options))
      kinds[i] = StructureKind::kFloor;
  }
  return kinds;
}

Eigen::Vector3d LevelUp(const Eigen::Vector3d& up_W, const LabelSurfaces& surfaces,
                        const StructureOptions& options) {
  SurfacePlane best;
  for (const LabelSurface& surface : surfaces) {
    if (surface.area < options.area || surface.area <= best.area) continue;
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
