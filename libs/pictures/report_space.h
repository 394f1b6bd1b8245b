#pragma once

#include <string>

#include "exports/outputs.h"
#include "pictures/report_parts.h"
#include "render/render_mesh.h"

namespace vismap {

/// What is known of the space: volumes of each state, a slice at the height of a robot, the octree.
std::string SpaceHtml(const OccupancyMap& space, const MapProducts& products, const SceneBox& scene,
                      const OctreeOptions& octree, const PictureSize& size);

}  // namespace vismap
