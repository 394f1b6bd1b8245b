#pragma once

#include <string>
#include <vector>

namespace vismap {

/// The noise of a depth sensor along the optical axis; lateral noise is not modelled. The
/// thresholds of the segmentation are multiples of it, so that they hold at every range. The
/// variance of depth is AxialSigma(z)^2 + (disparity_step_per_m z^2)^2 / 12, with the depth steps
/// as uniform noise; PreparePixels computes it.
struct DepthNoiseModel {
  double axial_base_m = 0.0012;           ///< standard deviation at z = axial_offset_m [m]
  double axial_quadratic_per_m = 0.0019;  ///< growth with (z - axial_offset_m)^2 [1/m]
  double axial_offset_m = 0.4;            ///< range of least noise [m]
  double disparity_step_per_m = 0.00285;  ///< depth step of one disparity step, over z^2 [1/m]
  /// Length over which the noise of neighbouring pixels is correlated [px]: the mean of n pixels is
  /// only as good as that of n / correlation_px^2 independent ones.
  double correlation_px = 2.5;

  /// Standard deviation of depth, without quantisation [m].
  double AxialSigma(double z) const {
    const double past = z > axial_offset_m ? z - axial_offset_m : 0.0;
    return axial_base_m + axial_quadratic_per_m * past * past;
  }

  friend bool operator==(const DepthNoiseModel&, const DepthNoiseModel&) = default;
};

/// PrimeSense sensors (Kinect v1, Asus Xtion). Axial noise: Nguyen, Izadi, Lovell 2012 (angle term
/// left out); disparity step: Khoshelham and Oude Elberink 2012, 2.85e-3 z^2; correlation: measured
/// on 7-Scenes, where second differences of inverse depth have the predicted size from a distance
/// of 2 to 4 pixels on.
inline DepthNoiseModel KinectNoise() { return {}; }

/// RealSense D400 stereo cameras: depth error z^2 * subpixel / (f * baseline) as in Intel's tuning
/// guide, with subpixel 0.08, f = 387 px (640 wide), baseline 0.05 m; disparity in steps of 1/32
/// px; the noise of neighbours is correlated by the matching window.
inline DepthNoiseModel RealSenseNoise() { return {0.001, 0.0041, 0.0, 0.0016, 3.0}; }

/// Rendered depth, rounded to millimetres.
inline DepthNoiseModel CleanNoise() { return {0.0003, 0.0, 0.0, 0.0, 1.0}; }

/// The problems of a noise model, one sentence each; empty = it is valid.
std::vector<std::string> Validate(const DepthNoiseModel& model);

}  // namespace vismap
