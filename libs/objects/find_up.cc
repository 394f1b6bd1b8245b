#include "objects/find_up.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <vector>

#include "objects/structure.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

constexpr double kStandsWithin = 0.08;   // [m] from a level
constexpr double kReachesBeyond = 0.02;  // share of a piece's points that may lie beyond a level
constexpr double kBesideLevel = 0.3;     // [m] between a level's bounds and what stands on it
constexpr double kLeastSupported = 0.5;  // [m^2] that must stand on levels to outvote the cameras
constexpr size_t kLeastPieces = 2;
constexpr double kMuchMore = 1.5;  // times the surface that stands on the cameras' own levels

double Cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180); }

// A large plane, with the side that its surface was seen from.
struct Level {
  size_t label = 0;
  SurfacePlane plane;
  Eigen::AlignedBox3d bounds_W;
  Vector3d facing_W = Vector3d::Zero();
};

std::vector<Level> FindLevels(const LabelSurfaces& surfaces, const StructureOptions& options) {
  std::vector<Level> levels;
  for (size_t label = 0; label < surfaces.size(); ++label) {
    const LabelSurface& surface = surfaces[label];
    if (surface.points_W.empty() || surface.area < options.structure_area_m2) continue;
    const SurfacePlane plane = FindPlane(surface.points_W, surface.area, options);
    if (plane.area < options.structure_area_m2 || plane.share < options.structure_share) continue;
    levels.push_back({label, plane, SpreadOf(surface.points_W).bounds_W, plane.normal_W});
  }
  return levels;
}

// Surface is seen from the side on which most of the other surface lies.
void FaceTheRest(const LabelSurfaces& surfaces, std::vector<Level>* levels) {
  for (Level& level : *levels) {
    double before = 0;
    for (size_t label = 0; label < surfaces.size(); ++label) {
      const LabelSurface& other = surfaces[label];
      if (label == level.label || other.points_W.empty()) continue;
      Vector3d mean = Vector3d::Zero();
      for (const Eigen::Vector3f& p : other.points_W) mean += p.cast<double>();
      mean /= static_cast<double>(other.points_W.size());
      before += (mean - level.plane.point_W).dot(level.facing_W) > 0 ? other.area : -other.area;
    }
    if (before < 0) level.facing_W = -level.facing_W;
  }
}

// Whether a piece touches a level, rises from it, and does not go through it.
bool StandsOn(const Level& level, const LabelSurface& piece) {
  std::vector<double> heights;
  Vector3d lowest = Vector3d::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& point : piece.points_W) {
    const Vector3d p = point.cast<double>();
    heights.push_back((p - level.plane.point_W).dot(level.facing_W));
    if (heights.back() >= least) continue;
    least = heights.back();
    lowest = p;
  }
  std::sort(heights.begin(), heights.end());
  const double bottom =
      heights[static_cast<size_t>(kReachesBeyond * static_cast<double>(heights.size() - 1))];
  return std::abs(bottom) <= kStandsWithin && heights.back() > 2 * kStandsWithin &&
         level.bounds_W.exteriorDistance(lowest) <= kBesideLevel;
}

struct Supported {
  double area = 0;  // [m^2]
  size_t pieces = 0;
};

// What stands on the levels that face a direction.
Supported SupportedAlong(const Vector3d& up_W, const std::vector<Level>& levels,
                         const LabelSurfaces& surfaces) {
  Supported supported;
  std::vector<const Level*> facing;
  for (const Level& level : levels) {
    if (level.facing_W.dot(up_W) > Cosine(20)) facing.push_back(&level);
  }
  for (size_t label = 0; label < surfaces.size(); ++label) {
    const LabelSurface& piece = surfaces[label];
    const bool large = std::any_of(levels.begin(), levels.end(),
                                   [&](const Level& level) { return level.label == label; });
    if (large || piece.points_W.empty() || piece.area < kLeastPieceArea) continue;
    if (std::none_of(facing.begin(), facing.end(),
                     [&](const Level* level) { return StandsOn(*level, piece); }))
      continue;
    supported.area += piece.area;
    ++supported.pieces;
  }
  return supported;
}

double Deviation(const CameraUp& cameras, const Vector3d& direction) {
  return std::sqrt(std::max(0.0, direction.dot(cameras.motion_W * direction)));
}

// Whether cameras that were rolled by a quarter turn would see this as up: it lies along their x
// axes, which did not turn, across their view, and they moved less along it than along what seems
// to be up.
bool MayBeAQuarterTurn(const CameraUp& cameras, const Vector3d& up_W) {
  constexpr double kLeastAlong = 0.6, kMostView = 0.75, kLevelMotion = 0.8, kNoMotion = 0.02;
  if (std::abs(cameras.right_W.dot(up_W)) < kLeastAlong) return false;
  if (std::abs(cameras.view_W.dot(up_W)) > kMostView) return false;
  const double across = Deviation(cameras, cameras.up_W);
  return across < kNoMotion || Deviation(cameras, up_W) <= kLevelMotion * across;
}

bool LooksUp(const CameraUp& cameras) { return cameras.view_W.dot(cameras.up_W) > 0.05; }

// Whether cameras that were upside down would see this as up: they looked up instead of down, and
// nearly all that stands on levels stands on those that face this direction.
bool MayBeUpsideDown(const CameraUp& cameras, const Vector3d& up_W, const Supported& found,
                     const Supported& of_cameras) {
  constexpr double kLeast = 1, kTimes = 4;  // [m^2]; of what stands on the cameras' levels
  return up_W.dot(cameras.up_W) < -Cosine(20) && LooksUp(cameras) && found.area >= kLeast &&
         found.area >= kTimes * of_cameras.area;
}

Vector3d Snapped(const Vector3d& direction) {
  Eigen::Index axis = 0;
  if (direction.cwiseAbs().maxCoeff(&axis) < Cosine(3)) return direction;
  Vector3d snapped = Vector3d::Zero();
  snapped[axis] = direction[axis] > 0 ? 1 : -1;
  return snapped;
}

// The direction that the map's levels vote for against the cameras, if any.
UpDirection Outvoted(const ObjectOptions& options, const LabelSurfaces& surfaces) {
  UpDirection up{options.up_W, options.cameras.reason};
  if (!MayBeRolled(options.cameras)) return up;
  std::vector<Level> levels = FindLevels(surfaces, options.structure);
  FaceTheRest(surfaces, &levels);
  const Supported of_cameras = SupportedAlong(options.up_W, levels, surfaces);
  Supported best;
  for (const Level& level : levels) {
    const Supported found = SupportedAlong(level.facing_W, levels, surfaces);
    if (found.area <= best.area || found.area < kLeastSupported || found.pieces < kLeastPieces ||
        found.area < kMuchMore * of_cameras.area)
      continue;
    if (!MayBeAQuarterTurn(options.cameras, level.facing_W) &&
        !MayBeUpsideDown(options.cameras, level.facing_W, found, of_cameras))
      continue;
    best = found;
    up.up_W = Snapped(level.facing_W);
  }
  if (best.pieces == 0) return up;
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "%.2g m2 of surface stands on levels that face this direction, and %.2g m2 on those "
      "that face %s, the direction of the cameras, which seem to be rolled",
      best.area, of_cameras.area, DirectionText(options.up_W).c_str());
  up.reason = text.data();
  return up;
}

}  // namespace

bool MayBeRolled(const CameraUp& cameras) {
  return cameras.right_W.norm() >= 0.6 || LooksUp(cameras);
}

UpDirection FindUp(const ObjectOptions& options, const LabelSurfaces& surfaces) {
  if (!options.up_is_guess) return {options.up_W, "as the config says"};
  UpDirection up = Outvoted(options, surfaces);
  const Vector3d refined = RefineUp(up.up_W, surfaces, options.structure);
  if (refined != up.up_W) up.reason += "; corrected to be upright on the largest level surface";
  up.up_W = refined;
  return up;
}

}  // namespace vismap
