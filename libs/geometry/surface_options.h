#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "geometry/noise_model.h"

namespace vismap {

/// How normals are estimated.
enum class NormalMethod {
  kInverseDepthFit,   ///< plane fitted to inverse depth in a window that ends at depth jumps
  kWindowCovariance,  ///< published code: covariance of the near points in a square window; slow
};

inline constexpr auto NamesOf(NormalMethod) {
  return std::to_array<EnumName<NormalMethod>>(
      {{"INVERSE_DEPTH_FIT", NormalMethod::kInverseDepthFit},
       {"WINDOW_COVARIANCE", NormalMethod::kWindowCovariance}});
}

/// Options of ComputeSurface.
struct SurfaceOptions {
  NormalMethod method = NormalMethod::kInverseDepthFit;
  DepthNoiseModel noise = KinectNoise();
  double min_depth_m = 0.1;  ///< nearer depth is no return [m]
  double max_depth_m = 10;   ///< farther depth is no return [m]
  /// Values that a camera gives where it measured nothing are no return, see DropSaturatedDepth.
  bool drop_saturated = true;
  /// Holes of at most this width along a row or a column are filled before anything else is made of
  /// the depth, where no depth jump can lie in them [px], see FillHoles; 0 = none.
  int max_hole_px = 4;

  // kInverseDepthFit
  /// Wanted standard deviation of the normals: the window grows with the noise to reach it [deg].
  double normal_sigma_deg = 7.0;
  int min_radius_px = 2;   ///< of the window [px at width 640]
  int max_radius_px = 10;  ///< of the window [px at width 640], at most 31
  /// Neighbours whose inverse depths differ by more standard deviations have a depth jump between
  /// them. The limit is raised for images that are noisier than the model, see JumpSigmas.
  double jump_sigmas = 5.0;
  /// Largest angle between normal and ray; steeper surfaces count as depth jumps [deg].
  double max_incidence_deg = 84;

  // kWindowCovariance (Grinvald 2019, published code)
  int window_px = 13;                ///< side of the square [px], odd
  double window_depth_ratio = 0.05;  ///< points farther away than this times z do not count
};

/// The problems of the options, one sentence each; empty = they are valid.
std::vector<std::string> Validate(const SurfaceOptions& options);

}  // namespace vismap
