#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace vismap {

/// How a depth sensor errs along the optical axis. Lateral noise is not modelled. All thresholds of
/// the segmentation are multiples of it, so that they hold at every range.
struct DepthNoiseModel {
  double axial_base_m = 0.0012;           ///< standard deviation at z = axial_offset_m [m]
  double axial_quadratic_per_m = 0.0019;  ///< growth with (z - axial_offset_m)^2 [1/m]
  double axial_offset_m = 0.4;            ///< range of least noise [m]
  double disparity_step_per_m = 0.00285;  ///< depth step of one disparity step, over z^2 [1/m]
  /// Pixels nearer than this err alike, so that averaging n of them is worth only n /
  /// correlation_px^2 [px].
  double correlation_px = 2.5;

  /// Standard deviation of depth, without quantisation [m].
  double AxialSigma(double z) const {
    const double past = z > axial_offset_m ? z - axial_offset_m : 0.0;
    return axial_base_m + axial_quadratic_per_m * past * past;
  }
  /// Distance between two depths that the sensor can tell apart [m].
  double QuantisationStep(double z) const { return disparity_step_per_m * z * z; }
  /// Standard deviation of depth with quantisation taken as uniform noise [m].
  double Sigma(double z) const {
    const double axial = AxialSigma(z), step = QuantisationStep(z);
    return std::sqrt(axial * axial + step * step / 12.0);
  }

  friend bool operator==(const DepthNoiseModel&, const DepthNoiseModel&) = default;
};

/// PrimeSense sensors (Kinect v1, Asus Xtion). Axial noise: Nguyen, Izadi, Lovell 2012 (angle term
/// left out); disparity step: Khoshelham and Oude Elberink 2012, 2.85e-3 z^2; correlation: measured
/// on 7-Scenes, where second differences of inverse depth reach the predicted size at 2 to 4
/// pixels.
inline DepthNoiseModel KinectNoise() { return {}; }

/// RealSense D400 stereo: depth error z^2 * subpixel / (f * baseline), as Intel's tuning guide has
/// it, with subpixel 0.08, f = 387 px (640 wide), baseline 0.05 m; disparity in steps of 1/32 px;
/// its matching window makes neighbours err alike.
inline DepthNoiseModel RealSenseNoise() { return {0.001, 0.0041, 0.0, 0.0016, 3.0}; }

/// Rendered depth kept in whole millimetres.
inline DepthNoiseModel CleanNoise() { return {0.0003, 0.0, 0.0, 0.0, 1.0}; }

/// All that is wrong with a model, one sentence each; empty = nothing.
std::vector<std::string> Validate(const DepthNoiseModel& model);

}  // namespace vismap
