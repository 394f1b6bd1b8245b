#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "geometry/noise_model.h"

namespace vismap {

/// How normals are estimated.
enum class NormalMethod {
  kInverseDepthFit,   ///< plane fit to inverse depth over an edge-bounded window
  kWindowCovariance,  ///< the published code: covariance of all points near in a square window;
                      ///< slow
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

  // kInverseDepthFit
  double normal_sigma_deg = 7.0;  ///< the window grows with noise until normals are this good [deg]
  int min_radius_px = 2;          ///< of the window [px at width 640]
  int max_radius_px = 10;         ///< of the window [px at width 640], at most 31
  /// Neighbours whose inverse depths differ by more are not joined; images that are noisier than
  /// the model stretch it, see JumpSigmas.
  double jump_sigmas = 5.0;
  double max_incidence_deg = 84;  ///< steeper surfaces count as depth jumps [deg]

  // kWindowCovariance (Grinvald 2019, published code)
  int window_px = 13;                ///< side of the square [px], odd
  double window_depth_ratio = 0.05;  ///< points farther than this times z are left out
};

/// The problems of the options, one sentence each; empty = they are valid.
std::vector<std::string> Validate(const SurfaceOptions& options);

}  // namespace vismap
