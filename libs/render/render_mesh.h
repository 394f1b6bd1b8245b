#pragma once

#include <optional>

#include "geometry/image.h"
#include "render/palette.h"
#include "render/view.h"

/// The room of pictures: meshes and maps drawn in software, for files and reports. It needs neither
/// a screen nor a graphics card.
namespace vismap {

inline constexpr Rgb8 kBackground{226, 229, 234};

/// The mesh as seen from `view`, lit from the viewer, smoothed 2x2. Triangles that face away are
/// not drawn: seen from above, ceilings vanish, and so do the near walls of a room seen from
/// outside.
Image<Rgb8> RenderMesh(const Mesh& mesh, const View& view, Coloring coloring);

/// Pixel (u, v) of a point of W, if it is in front of the viewer; it may lie outside the picture.
std::optional<Eigen::Vector2d> ProjectToView(const View& view, const Eigen::Vector3d& p_W);

}  // namespace vismap
