#include "geometry/surface_options.h"

namespace vismap {
namespace {

/// Collects a sentence for every condition that does not hold.
class Problems {
 public:
  void Unless(bool ok, const char* sentence) {
    if (!ok) list_.emplace_back(sentence);
  }
  std::vector<std::string> list() && { return std::move(list_); }

 private:
  std::vector<std::string> list_;
};

bool InRange(double x, double low, double high) { return x >= low && x <= high; }  // false for NaN

}  // namespace

std::vector<std::string> Validate(const DepthNoiseModel& model) {
  Problems problems;
  problems.Unless(InRange(model.axial_base_m, 1e-6, 1.0), "axial_base_m must be in [1e-6, 1] m");
  problems.Unless(InRange(model.axial_quadratic_per_m, 0, 1),
                  "axial_quadratic_per_m must be in [0, 1]");
  problems.Unless(InRange(model.axial_offset_m, 0, 10), "axial_offset_m must be in [0, 10] m");
  problems.Unless(InRange(model.disparity_step_per_m, 0, 1),
                  "disparity_step_per_m must be in [0, 1]");
  problems.Unless(InRange(model.correlation_px, 1, 20), "correlation_px must be in [1, 20] px");
  return std::move(problems).list();
}

std::vector<std::string> Validate(const SurfaceOptions& options) {
  Problems problems;
  problems.Unless(InRange(options.min_depth_m, 0.001, 1000),
                  "min_depth_m must be in [0.001, 1000] m");
  problems.Unless(InRange(options.max_depth_m, options.min_depth_m, 1000),
                  "max_depth_m must be in [min_depth_m, 1000] m");
  problems.Unless(InRange(options.normal_sigma_deg, 0.1, 45),
                  "normal_sigma_deg must be in [0.1, 45]");
  problems.Unless(options.min_radius_px >= 1 && options.min_radius_px <= options.max_radius_px,
                  "min_radius_px must be in [1, max_radius_px]");
  problems.Unless(options.max_radius_px <= 31, "max_radius_px must be at most 31");
  problems.Unless(InRange(options.jump_sigmas, 0.1, 1000), "jump_sigmas must be in [0.1, 1000]");
  problems.Unless(InRange(options.max_incidence_deg, 10, 89.9),
                  "max_incidence_deg must be in [10, 89.9]");
  problems.Unless(options.window_px >= 3 && options.window_px <= 63 && options.window_px % 2 == 1,
                  "window_px must be odd and in [3, 63]");
  problems.Unless(InRange(options.window_depth_ratio, 1e-4, 1),
                  "window_depth_ratio must be in [1e-4, 1]");
  auto list = std::move(problems).list();
  for (const std::string& problem : Validate(options.noise)) list.push_back("noise_" + problem);
  return list;
}

}  // namespace vismap
