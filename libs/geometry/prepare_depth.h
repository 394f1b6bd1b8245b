#pragma once

#include <cstdint>

#include "geometry/fill_holes.h"
#include "geometry/frame.h"
#include "geometry/image.h"
#include "geometry/surface_options.h"

namespace vismap {

/// What is done to the depth of a frame before anything else is made of it.
struct PrepareDepthOptions {
  double min_depth_m = SurfaceOptions().min_depth_m;  ///< nearer depth is no return [m]
  double max_depth_m = SurfaceOptions().max_depth_m;  ///< farther depth is no return [m]
  HoleOptions holes{};
};

/// The options that belong to those of the surface.
PrepareDepthOptions PrepareDepthOptionsOf(const SurfaceOptions& options);

/// Depth (HxW [m]) outside of [min_depth_m, max_depth_m] becomes NaN, no return, so that no later
/// stage sees surface or free space in it; then small holes are filled, see FillHoles.
void PrepareDepth(const PrepareDepthOptions& options, Image<float>* depth);

/// The same for the depth of a frame. Sets `measured_depth` when depth is taken out.
void PrepareDepth(const PrepareDepthOptions& options, RgbdFrame* frame);

}  // namespace vismap
