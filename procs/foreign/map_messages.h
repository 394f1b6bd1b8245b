#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>
#include <vismap/foreign/drake/lcmt_point_cloud.hpp>
#include <vismap/foreign/drake/lcmt_viewer_load_robot.hpp>
#include <vismap/foreign/nav_msgs/OccupancyGrid.hpp>
#include <vismap/foreign/robotlocomotion/viewer2_comms_t.hpp>
#include <vismap/foreign/sensor_msgs/PointCloud2.hpp>
#include <vismap/foreign/vision_msgs/Detection3DArray.hpp>

#include "base/class_names.h"
#include "base/result.h"
#include "freespace/occupancy_map.h"
#include "meshing/mesh.h"
#include "objects/objects.h"

namespace vismap {

// Our map in the messages of other robots' programs. All of them have W with z up.

/// A point of the surface.
struct SurfacePoint {
  Eigen::Vector3f p_W;  ///< [m]
  Rgb8 color;
};

/// One vertex of each cube of `spacing` [m] that has some: the first one.
std::vector<SurfacePoint> ThinOut(const Mesh& mesh, double spacing);
/// The mesh with the vertices of each cube of `spacing` [m] joined to the first one. Triangles that
/// have no three corners any more are gone.
Mesh Coarsened(const Mesh& mesh, double spacing);

/// DimOS: x, y, z, rgb as float32 at 0, 4, 8, 12; the bits of rgb are 0x00RRGGBB.
foreign::sensor_msgs::PointCloud2 ToPointCloud2(std::span<const SurfacePoint> points,
                                                const std::string& frame, int64_t utime);
/// Drake's Meldis: x, y, z as float32 and the bytes r, g, b, 0.
foreign::drake::lcmt_point_cloud ToDrakeCloud(std::span<const SurfacePoint> points,
                                              const std::string& frame, int64_t utime);

/// How space becomes a map in two dimensions.
struct CostmapOptions {
  double resolution = 0.05;  ///< edge of a cell [m]
  double min_z = 0.1;        ///< only what lies between these heights counts [m]
  double max_z = 1.0;
  int unknown = 100;  ///< value of cells that were not seen; -1 is DimOS's own
};

/// DimOS: 100 where any space of a column is occupied, 0 where some is free and none occupied.
/// Fails when the grid would have more than 2^24 cells.
Result<foreign::nav_msgs::OccupancyGrid> ToCostmap(const OccupancyMap& space,
                                                   const CostmapOptions& options,
                                                   const std::string& frame, int64_t utime);

/// DimOS: the objects that are there, with class name, score and full extents.
foreign::vision_msgs::Detection3DArray ToDetections(std::span<const ObjectSummary> objects,
                                                    const ClassNamer& class_name,
                                                    const std::string& frame, int64_t utime);

/// Drake's Meldis, for the channel DRAKE_VIEWER_DEFORMABLE: the surface of each object
/// (`meshes`, in their order) and its box, as meshes.
foreign::drake::lcmt_viewer_link_data ToDeformable(std::span<const ObjectSummary> objects,
                                                   std::span<const Mesh> meshes,
                                                   const ClassNamer& class_name);

/// director, format treeviewer_json 1.0: the surface as points, the objects as boxes. `shown` are
/// the names of the boxes that director has; those that are gone are deleted. It is updated.
foreign::robotlocomotion::viewer2_comms_t ToTreeviewer(std::span<const SurfacePoint> points,
                                                       std::span<const ObjectSummary> objects,
                                                       const ClassNamer& class_name, int64_t utime,
                                                       std::set<std::string>* shown);

}  // namespace vismap
