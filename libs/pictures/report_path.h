#pragma once

#include <set>
#include <span>
#include <string>

#include "map/map_metadata.h"
#include "pictures/report_parts.h"
#include "render/render_mesh.h"

namespace vismap {

std::set<CameraId> CamerasOf(std::span<const CameraPose> trajectory);

/// The ways of the cameras over the map, seen from above, and their lengths.
std::string TrajectoryHtml(std::span<const CameraPose> trajectory, const Mesh& mesh,
                           const SceneBox& scene, const PictureSize& size);

}  // namespace vismap
