#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "simulation/scene.h"

namespace vismap {

/// Triangles with a label per vertex: the ground truth that scorers read.
struct LabelledMesh {
  std::vector<Eigen::Vector3d> points_W;  ///< [m]
  std::vector<uint16_t> object_ids;       ///< of each point
  std::vector<std::array<int, 3>> triangles;
};

/// The surface of the scene in triangles with edges of about `spacing` [m], points exactly on the
/// surface: only where it borders free space and `keep(p_W, normal_W)` holds at all corners.
LabelledMesh Tessellate(
    const Scene& scene, double spacing,
    const std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>& keep);

}  // namespace vismap
