#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

namespace vismap {

/// The kind of a large plane that is not part of an instance. Heights are above the floor.
enum class StructureKind : uint8_t {
  kNone,      ///< not structure
  kFloor,     ///< level, lower than table_low_m; small flat pieces at the height of a floor, too
  kTableTop,  ///< level, from table_low_m to table_high_m
  kCeiling,   ///< level, from ceiling_low_m on
  kWall,      ///< vertical
  kSloped,    ///< neither level nor vertical, or level between table_high_m and ceiling_low_m
};

/// The name of a kind in files: "none", "floor", "table_top", "ceiling", "wall", "sloped".
const char* NameOf(StructureKind kind);

/// What counts as structure. Lengths in m, areas in m^2.
struct StructureOptions {
  /// A point lies in a plane if it is within this distance of it; far walls are noisy.
  double structure_flatness_m = 0.03;
  double structure_share = 0.8;    ///< least share of a surface that lies in its plane
  double structure_area_m2 = 1.0;  ///< least area that lies in the plane
  /// The same for table tops, which are smaller and have edges that are not in the plane.
  double table_share = 0.6;
  double table_area_m2 = 0.3;
  double table_low_m = 0.3;    ///< least height of a table top
  double table_high_m = 1.6;   ///< largest height of a table top
  double ceiling_low_m = 1.8;  ///< least height of a ceiling
  double max_tilt_deg = 12;    ///< largest angle from level or vertical [deg]
  /// A piece is flush with a structure plane, and part of it, if its root mean square distance from
  /// the plane is less than this multiple of the plane's roughness, and if the gap between their
  /// bounds is at most flush_gap_m. Table tops are excluded, because flat objects lie on them. 0 =
  /// no piece is flush.
  double flush_roughness = 2.0;
  double flush_gap_m = 0.5;  ///< largest gap between the bounds, see flush_roughness
};

/// The plane that fits a surface best.
struct SurfacePlane {
  Eigen::Vector3d point_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< unit length, of either sign
  double share = 0;  ///< share of the points within `flatness` of it, [0, 1]
  double area = 0;   ///< area of that share [m^2]
  /// Root mean square distance of the points within 2 * `flatness` [m]: mostly the sensor's noise.
  double roughness = 0;
  double joint_area = 0;  ///< area of all flat pieces in it [m^2], see JoinFlushAreas; 0 = not set
};

/// Mean, covariance and bounds of the points of a surface.
struct SurfaceSpread {
  Eigen::Vector3d mean_W = Eigen::Vector3d::Zero();        ///< [m]
  Eigen::Matrix3d covariance_W = Eigen::Matrix3d::Zero();  ///< [m^2]
  Eigen::AlignedBox3d bounds_W;                            ///< [m]; empty = no points
};

/// The spread of points of W [m]. An even sample of the points gives about the same result.
SurfaceSpread SpreadOf(std::span<const Eigen::Vector3f> points_W);

/// The area of a flat rectangle with the same spread along its two axes as the surface has along
/// its two main axes: 12 * sqrt(l1 * l2) [m^2], where l1 and l2 are the two largest eigenvalues of
/// the covariance. It is about the area of a flat plate, less than that of a solid body, and much
/// more than that of scattered specks.
double SpannedArea(const SurfaceSpread& spread);

/// The plane through at most 4000 of the points [m], evenly chosen (see FitPlane). `area` is the
/// area of the whole surface [m^2]. The default if there are no points.
SurfacePlane FindPlane(std::span<const Eigen::Vector3f> points_W, double area,
                       const StructureOptions& options);

/// Sets the joint area of flat pieces: the area of the piece and of all other flat pieces that are
/// flush with it (the smaller piece with the plane of the larger one). Furniture divides a wall
/// into pieces, each of which may be too small for a wall. Table tops do not use the joint area,
/// because several flat objects of the same height may lie side by side. `spreads` are of the same
/// surfaces.
void JoinFlushAreas(std::span<const SurfaceSpread> spreads, const StructureOptions& options,
                    std::vector<SurfacePlane>* planes);

/// The kind of each plane; kNone for planes without area. The height of the floor is that of the
/// lowest level plane that is large enough, or `lowest` [m along up_W] if there is none.
std::vector<StructureKind> NameStructure(std::span<const SurfacePlane> planes,
                                         const Eigen::Vector3d& up_W, double lowest,
                                         const StructureOptions& options);

/// Gives each piece without a kind that is flush with a structure plane (see flush_roughness) the
/// kind of that plane. So the small pieces of a wall that furniture or the border of a mask has
/// divided are wall, too. If there are several planes, the one with the smallest distance relative
/// to its roughness counts, ties to the first. The roughness of a plane shows the noise of the
/// sensor at that distance, so an object that stands out from the plane by more than noise is not
/// changed. Pieces with an empty spread do not change.
void NameFlushPieces(std::span<const SurfacePlane> planes, std::span<const SurfaceSpread> spreads,
                     const StructureOptions& options, std::vector<StructureKind>* kinds);

}  // namespace vismap
