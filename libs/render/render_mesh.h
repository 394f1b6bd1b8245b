#pragma once

#include <optional>

#include "geometry/image.h"
#include "render/palette.h"
#include "render/view.h"

/// The room `render` draws meshes and maps in software, for files and reports. It needs neither a
/// screen nor a graphics card.
namespace vismap {

/// The colour of pixels without surface.
inline constexpr Rgb8 kBackground{226, 229, 234};

/// Draws the mesh as seen from `view`, with a light at the viewer and 2 x 2 samples per pixel.
/// Triangles that face away from the viewer are not drawn, so a view from above shows a room
/// without its ceiling, and a view from outside without its near walls.
Image<Rgb8> RenderMesh(const Mesh& mesh, const View& view, Coloring coloring);

/// The pixel (u, v) of a point of W [m]; it may be outside of the picture. None if the point is not
/// in front of the viewer.
std::optional<Eigen::Vector2d> ProjectToView(const View& view, const Eigen::Vector3d& p_W);

}  // namespace vismap
