#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "simulation/scene.h"

namespace vismap {

/// Triangles with an object id per vertex: the ground truth of an evaluation.
struct LabelledMesh {
  std::vector<Eigen::Vector3d> points_W;      ///< [m]
  std::vector<uint16_t> object_ids;           ///< of each point
  std::vector<std::array<int, 3>> triangles;  ///< indices of points
};

/// The surface of the scene as triangles with edges of about `spacing` [m] and points exactly on
/// the surface. It has only triangles at whose corners the surface borders free space and keep(p_W,
/// normal_W) is true.
LabelledMesh Tessellate(
    const Scene& scene, double spacing,
    const std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>& keep);

}  // namespace vismap
