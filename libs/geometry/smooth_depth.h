#pragma once

#include "geometry/image.h"
#include "geometry/noise_model.h"

namespace vismap {

/// The largest DepthSmoothing::radius_px.
inline constexpr int kMostSmoothRadius = 8;

/// How far and over which differences SmoothDepth averages.
struct DepthSmoothing {
  int radius_px = 4;  ///< of the window; 0 = none
  /// Bends of the inverse depth up to so many standard deviations count as noise.
  double sigmas = 2.0;
};

/// The depth image [m] with less noise and without the steps of disparity: around every pixel, the
/// mean of the inverse depth w over pairs of pixels that lie opposite to each other,
///   |w(p - k) + w(p + k) - 2 w(p)| <= sigmas sqrt(6) σ_w(p),   k = 1, 2, ... radius_px,
/// up to the first pair that is farther off or lacks depth, along the row, then along the column.
/// A plane is linear in w, so it stays what it is at any slant; at an edge, at the rim and on what
/// is thinner than two pixels nothing is averaged. σ_w is that of `noise`, with the steps. Pixels
/// without return (NaN) stay as they are. Twin: naive::SmoothDepth.
Image<float> SmoothDepth(const Image<float>& depth, const DepthNoiseModel& noise,
                         const DepthSmoothing& options);

}  // namespace vismap
