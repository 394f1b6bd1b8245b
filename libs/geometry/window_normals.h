#pragma once

#include "geometry/surface.h"
#include "geometry/surface_options.h"

namespace vismap {

/// The published method, and the slow reference of ComputeSurface: for each pixel, the direction of
/// least variance of all points in a square window that are nearer than window_depth_ratio * z.
/// Fills the normals (and normal_sigma, from the window's count) of a surface whose points are
/// given.
void EstimateWindowNormals(const SurfaceOptions& options, SurfaceMap* surface);

}  // namespace vismap
