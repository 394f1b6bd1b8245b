#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

namespace vismap {

/// What a large plane is that no detector has named.
enum class StructureKind : uint8_t {
  kNone,      ///< no structure: a thing
  kFloor,     ///< level, at about the height of the lowest such plane; and all bits of it
  kTableTop,  ///< level, where people put things
  kCeiling,   ///< level, above their heads
  kWall,      ///< upright
  kSloped,    ///< neither level nor upright, or level at an unusual height
};

/// "floor", "table_top", ...; "none".
const char* NameOf(StructureKind kind);

/// Lengths in m, areas in m^2.
struct StructureOptions {
  double flatness =
      0.03;  ///< most points lie within this distance of a plane (far walls are noisy) ...
  double share = 0.8;  ///< ... and this is most ...
  double area = 1.0;   ///< ... with at least this surface
  /// Level planes from `table_low` to `table_high` above the floor need less: tops have rims.
  double table_share = 0.6;
  double table_area = 0.3;
  double table_low = 0.3;
  double table_high = 1.6;
  double ceiling_low = 1.8;  ///< level planes from here on above the floor are ceiling
  double max_tilt_deg = 12;  ///< of level and upright planes
  /// A piece that is no farther from a plane of structure than this times the plane's own roughness
  /// (root mean square) is flush with it and belongs to it, unless that is a table top, on which
  /// flat things lie; 0 = never ...
  double flush_roughness = 2.0;
  double flush_gap = 0.5;  ///< ... if no more than this lies between the two
};

/// The plane that fits a surface best.
struct SurfacePlane {
  Eigen::Vector3d point_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< unit, either side
  double share = 0;                                     ///< of the surface that lies in it, [0, 1]
  double area = 0;                                      ///< of that
  /// Root mean square distance from it of what is within twice the flatness: noise, mostly [m].
  double roughness = 0;
  double joint_area = 0;  ///< with that of other flat pieces in it, see JoinFlushAreas; 0 = alone
};

/// Where a surface lies, to the second order.
struct SurfaceSpread {
  Eigen::Vector3d mean_W = Eigen::Vector3d::Zero();        ///< of its points [m]
  Eigen::Matrix3d covariance_W = Eigen::Matrix3d::Zero();  ///< of its points [m^2]
  Eigen::AlignedBox3d bounds_W;                            ///< empty = no points [m]
};

/// The spread of points of W [m]; any even pick of a surface gives about the same.
SurfaceSpread SpreadOf(std::span<const Eigen::Vector3f> points_W);

/// The area of the flat rectangle that spreads as far along the surface's two main axes [m^2]: what
/// a plate shows, less than what a body shows, and far more than shreds do.
double SpannedArea(const SurfaceSpread& spread);

SurfacePlane FindPlane(std::span<const Eigen::Vector3f> points_W, double area,
                       const StructureOptions& options);

/// Sets the joint area of planes from the flat pieces of surface that are flush with each other
/// (the smaller one with the plane of the larger one): furniture cuts a wall into pieces none of
/// which may be large enough for one. Table tops are told by what is in one piece: flat things of
/// one height may lie side by side. `spreads` = of the same surfaces.
void JoinFlushAreas(std::span<const SurfaceSpread> spreads, const StructureOptions& options,
                    std::vector<SurfacePlane>* planes);

/// Names each plane; those without area are none. The floor is the lowest level plane of at least
/// `area`, or where there is none, `lowest` [m along up_W].
std::vector<StructureKind> NameStructure(std::span<const SurfacePlane> planes,
                                         const Eigen::Vector3d& up_W, double lowest,
                                         const StructureOptions& options);

/// Gives what has no kind, but is flush with a plane that has one (see `flush_roughness`), the kind
/// of that plane: of a wall that furniture or a mask's rim cuts into pieces, the small ones are
/// wall, too. The plane is the one it is closest to, ties to the first. How rough a plane is tells
/// how noisy the sensor is at that distance, so that what stands out of it stays a thing. Pieces
/// with an empty spread stay as they are.
void NameFlushPieces(std::span<const SurfacePlane> planes, std::span<const SurfaceSpread> spreads,
                     const StructureOptions& options, std::vector<StructureKind>* kinds);

}  // namespace vismap
