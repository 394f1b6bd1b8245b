#pragma once

#include <Eigen/Core>

#include "meshing/mesh.h"
#include "render/drawing.h"

namespace vismap {

// Pictures of values: the colours of the vertices are replaced, and drawn with Coloring::kRgb.

/// Colours by the height along `up_W` (unit length), from the lowest to the highest 1 %. Returns
/// the scale, with heights in W [m].
ColorScale PaintHeights(const Eigen::Vector3d& up_W, Mesh* mesh);

/// Colours by MeshVertex::seen, logarithmically from 1 to 255. Vertices of which it is not known
/// become grey (kUnsegmentedColor). Returns the scale.
ColorScale PaintSeen(Mesh* mesh);

/// Removes the triangles that are not wholly below this height along `up_W` [m].
void CutAbove(const Eigen::Vector3d& up_W, double height_m, Mesh* mesh);

}  // namespace vismap
