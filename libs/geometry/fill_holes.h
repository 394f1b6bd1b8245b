#pragma once

#include "geometry/image.h"
#include "geometry/noise_model.h"
#include "geometry/surface_options.h"

namespace vismap {

/// Which holes of a depth image are filled.
struct HoleOptions {
  /// Wider holes stay, measured along a row or a column [px], at most kMaxHolePx; 0 = all stay.
  int max_px = 4;
  /// The pixels on both sides of a hole must agree within so many standard deviations.
  double sigmas = 5.0;
  DepthNoiseModel noise = KinectNoise();
};

/// The options of FillHoles that agree with those of the surface: a hole is filled where its two
/// sides would be joined if they were neighbours.
HoleOptions HoleOptionsOf(const SurfaceOptions& options);

/// Fills the small holes of a depth image (HxW [m] along z; NaN = no return), such as the rows and
/// columns of zeros that registration to colour leaves. Measured depth is never changed.
///
/// A hole is filled from the nearest pixels with depth on its two sides, along the row or along the
/// column, whichever is shorter (the row when both are equal). The inverse depth, in which planes
/// are linear, is interpolated between them. A hole is filled only where no depth jump can lie in
/// it: the inverse depths of the two sides are equal within the noise, or the slope between them is
/// that of the surface before the hole and that of the surface after it. A second pass fills what
/// lies between filled pixels, such as the crossings of missing rows and columns. See
/// libs/METHOD.md, Holes.
void FillHoles(const HoleOptions& options, Image<float>* depth);

}  // namespace vismap
