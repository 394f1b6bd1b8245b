#pragma once

#include "geometry/surface.h"
#include "geometry/surface_options.h"

namespace vismap {

/// The normals of the published method: for each pixel, the direction of least variance of the
/// points in a square window that are nearer to the pixel's point than window_depth_ratio * z.
/// Computes normals_C of a surface whose points are given; normal_sigma is 0 where there is a
/// normal.
void EstimateWindowNormals(const SurfaceOptions& options, SurfaceMap* surface);

}  // namespace vismap
