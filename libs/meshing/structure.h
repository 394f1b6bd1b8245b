#pragma once

#include <Eigen/Core>
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
};

/// The plane that fits a surface best.
struct SurfacePlane {
  Eigen::Vector3d point_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< unit, either side
  double share = 0;                                     ///< of the surface that lies in it, [0, 1]
  double area = 0;                                      ///< of that
};

SurfacePlane FindPlane(std::span<const Eigen::Vector3f> points_W, double area,
                       const StructureOptions& options);

/// Names each plane; those without area are none. The floor is the lowest level plane of at least
/// `area`, or where there is none, `lowest` [m along up_W].
std::vector<StructureKind> NameStructure(std::span<const SurfacePlane> planes,
                                         const Eigen::Vector3d& up_W, double lowest,
                                         const StructureOptions& options);

}  // namespace vismap
