#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <vector>
#include <vismap/mesh_block_t.hpp>

#include "geometry/camera.h"
#include "geometry/pose.h"
#include "viewer/object_mask.h"
#include "viewer/page_messages.h"

namespace vismap::testing_support {

/// A box along the axes of W [m] as the surface of an object.
struct ScenePart {
  Eigen::AlignedBox3d box_W;
  int instance = 0, segment = 1;
};

/// The surface of the boxes, as one block of 4 m.
inline SurfaceBlock BlockOf(const std::vector<ScenePart>& parts) {
  mesh_block_t block{};
  block.edge_m = 4;
  for (const ScenePart& part : parts) {
    const int first = block.n_vertices;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d p_W =
          part.box_W.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
      const auto steps = [&](double x) {
        return static_cast<int16_t>(static_cast<uint16_t>(std::lround((x / 4 + 0.5) / 2 * 65535)));
      };
      block.x.push_back(steps(p_W.x()));
      block.y.push_back(steps(p_W.y()));
      block.z.push_back(steps(p_W.z()));
      block.instance.push_back(part.instance);
      block.segment.push_back(part.segment);
      ++block.n_vertices;
    }
    // Bits of a corner's number: x, y, z.
    for (const auto& [a, b, c, d] : std::array<std::array<int, 4>, 6>{{{0, 1, 3, 2},
                                                                       {4, 5, 7, 6},
                                                                       {0, 1, 5, 4},
                                                                       {2, 3, 7, 6},
                                                                       {0, 2, 6, 4},
                                                                       {1, 3, 7, 5}}}) {
      for (const auto& [i, j, k] : {std::array{a, b, c}, std::array{a, c, d}}) {
        block.a.push_back(first + i);
        block.b.push_back(first + j);
        block.c.push_back(first + k);
        ++block.n_triangles;
      }
    }
  }
  const auto count = static_cast<size_t>(block.n_vertices);
  block.nx = block.ny = block.nz = std::vector<int8_t>(count, 0);
  block.red = block.green = block.blue = block.seen = std::vector<uint8_t>(count, 0);
  block.class_id = std::vector<int16_t>(count, 0);
  return {{0, 0, 0}, std::make_shared<const std::vector<uint8_t>>(EncodePageBlock(block, 1, 1))};
}

/// A cube (instance 7) before a wall, and a post (instance 9) before a part of the cube. All of it
/// is seen from the origin along +z.
struct CubeScene {
  std::vector<ScenePart> parts = {
      {{Eigen::Vector3d(-0.3, -0.25, 1.8), Eigen::Vector3d(0.3, 0.25, 2.2)}, 7, 70},
      {{Eigen::Vector3d(-1.9, -1.9, 3.0), Eigen::Vector3d(1.9, 1.9, 3.1)}, 0, 1},
      {{Eigen::Vector3d(0.1, -1.0, 1.0), Eigen::Vector3d(0.2, 1.0, 1.1)}, 9, 90}};
  PinholeCamera camera{320, 240, 260, 260, 159.5, 119.5};

  /// A camera that is turned and moved a little.
  static Pose Tilted() {
    Pose T_W_C = Pose::Identity();
    T_W_C.linear() = (Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()) *
                      Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitZ()))
                         .toRotationMatrix();
    T_W_C.translation() = Eigen::Vector3d(-0.2, 0.1, -0.1);
    return T_W_C;
  }

  /// Depth at which the ray through a pixel meets a box; 0 = it does not.
  static double DepthOf(const ScenePart& part, const PinholeCamera& camera, const Pose& T_W_C,
                        int u, int v) {
    const Eigen::Vector3d ray = T_W_C.linear() * camera.BackProject(u, v, 1);
    double near = 0, far = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (part.box_W.min()[axis] - T_W_C.translation()[axis]) / ray[axis];
      const double b = (part.box_W.max()[axis] - T_W_C.translation()[axis]) / ray[axis];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    return near <= far ? near : 0;
  }

  /// The instance that is nearest in a pixel, and its depth [m]; -1 = nothing.
  std::pair<int, double> NearestAt(const Pose& T_W_C, int u, int v) const {
    std::pair<int, double> nearest{-1, 0};
    for (const ScenePart& part : parts) {
      const double depth = DepthOf(part, camera, T_W_C, u, v);
      if (depth > 0 && (nearest.first < 0 || depth < nearest.second))
        nearest = {part.instance, depth};
    }
    return nearest;
  }
};

}  // namespace vismap::testing_support
