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
  problems.Unless(InRange(model.axial_base, 1e-6, 1.0), "axial_base must be in [1e-6, 1] m");
  problems.Unless(InRange(model.axial_quadratic, 0, 1), "axial_quadratic must be in [0, 1]");
  problems.Unless(InRange(model.axial_offset, 0, 10), "axial_offset must be in [0, 10] m");
  problems.Unless(InRange(model.disparity_step, 0, 1), "disparity_step must be in [0, 1]");
  problems.Unless(InRange(model.correlation, 1, 20), "correlation must be in [1, 20] px");
  return std::move(problems).list();
}

std::vector<std::string> Validate(const SurfaceOptions& options) {
  Problems problems;
  problems.Unless(InRange(options.min_depth, 0.001, 1000), "min_depth must be in [0.001, 1000] m");
  problems.Unless(InRange(options.max_depth, options.min_depth, 1000),
                  "max_depth must be in [min_depth, 1000] m");
  problems.Unless(InRange(options.normal_sigma_deg, 0.1, 45),
                  "normal_sigma_deg must be in [0.1, 45]");
  problems.Unless(options.min_radius >= 1 && options.min_radius <= options.max_radius,
                  "min_radius must be in [1, max_radius]");
  problems.Unless(options.max_radius <= 31, "max_radius must be at most 31");
  problems.Unless(InRange(options.jump_sigmas, 0.1, 1000), "jump_sigmas must be in [0.1, 1000]");
  problems.Unless(InRange(options.max_incidence_deg, 10, 89.9),
                  "max_incidence_deg must be in [10, 89.9]");
  problems.Unless(options.window >= 3 && options.window <= 63 && options.window % 2 == 1,
                  "window must be odd and in [3, 63]");
  problems.Unless(InRange(options.window_depth, 1e-4, 1), "window_depth must be in [1e-4, 1]");
  auto list = std::move(problems).list();
  for (const std::string& problem : Validate(options.noise)) list.push_back("noise." + problem);
  return list;
}

}  // namespace vismap
