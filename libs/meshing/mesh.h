#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "map/semantic_map.h"

namespace vismap {

/// A vertex of the surface, with the ids of the segment and object that it belongs to.
struct MeshVertex {
  Eigen::Vector3f position_W = Eigen::Vector3f::Zero();  ///< [m]
  Eigen::Vector3f normal_W = Eigen::Vector3f::Zero();    ///< unit length, towards free space
  Rgb8 color;
  SegmentLabel segment = SegmentLabel::kNone;  ///< alive label
  InstanceId instance = InstanceId::kNone;
  ClassId class_id = ClassId::kUnknown;  ///< of the instance
  /// Number of frames that observed the surface here; 255 = 255 or more, 0 = not known.
  uint8_t seen = 0;
};

/// Triangles over shared vertices; counter-clockwise seen from free space.
struct Mesh {
  std::vector<MeshVertex> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
};

}  // namespace vismap
