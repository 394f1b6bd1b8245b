#pragma once

#include "geometry/image.h"
#include "geometry/noise_model.h"
#include "geometry/surface_options.h"

namespace vismap {

/// Which holes of a depth image are filled.
struct HoleOptions {
  /// Wider holes stay, measured along a row or a column [px], at most kMaxHolePx; 0 = all stay.
  int max_px = 4;
  /// The pixels on both sides of a hole must agree within so many standard deviations; up to 2.5
  /// times as many in images that are noisier than the model, see HoleSigmas.
  double sigmas = 3.0;
  DepthNoiseModel noise = KinectNoise();
};

/// The options of FillHoles that belong to those of the surface. The two sides of a hole must agree
/// better than neighbours that are joined, since what lies between them was not seen: within 0.6
/// times the `jump_sigmas`.
HoleOptions HoleOptionsOf(const SurfaceOptions& options);

/// The standard deviations within which the sides of holes must agree in this image: 1.5 times
/// BendAcrossHoles, within [1, 2.5] times `sigmas`.
double HoleSigmas(const Image<float>& depth, const HoleOptions& options);

/// Fills the small holes of a depth image (HxW [m] along z; NaN = no return), such as the rows and
/// columns of zeros that registration to colour leaves. Measured depth is never changed.
///
/// A hole is filled from the nearest pixels with depth on its two sides, along the row or along the
/// column, whichever is shorter (the row when both are equal). The inverse depth, in which planes
/// are linear, is interpolated between them. A hole is filled only where no depth jump can lie in
/// it: the inverse depths of the two sides are equal within the noise or, where that holds along
/// neither line, the slope between them is that of the surface before the hole and that of the
/// surface after it. A second pass fills what lies between filled pixels, such as the crossings of
/// missing rows and columns. See libs/METHOD.md, Holes.
void FillHoles(const HoleOptions& options, Image<float>* depth);

}  // namespace vismap
