#include "geometry/surface_options.h"

#include "base/option_check.h"
#include "geometry/hole_kernels.h"

namespace vismap {
std::vector<std::string> Validate(const DepthNoiseModel& model) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, model.axial_base_m, 1e-6, 1);
  VISMAP_CHECK_RANGE(check, model.axial_quadratic_per_m, 0, 1);
  VISMAP_CHECK_RANGE(check, model.axial_offset_m, 0, 10);
  VISMAP_CHECK_RANGE(check, model.disparity_step_per_m, 0, 1);
  VISMAP_CHECK_RANGE(check, model.correlation_px, 1, 20);
  return std::move(check).problems();
}

std::vector<std::string> Validate(const SurfaceOptions& options) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, options.min_depth_m, 0.001, 1000);
  check.Unless(options.max_depth_m >= options.min_depth_m && options.max_depth_m <= 1000,
               "max_depth_m must be in [min_depth_m, 1000]");
  VISMAP_CHECK_RANGE(check, options.max_hole_px, 0, kMaxHolePx);
  VISMAP_CHECK_RANGE(check, options.normal_sigma_deg, 0.1, 45);
  check.Unless(options.min_radius_px >= 1 && options.min_radius_px <= options.max_radius_px,
               "min_radius_px must be in [1, max_radius_px]");
  check.Unless(options.max_radius_px <= 31, "max_radius_px must be at most 31");
  VISMAP_CHECK_RANGE(check, options.jump_sigmas, 0.1, 1000);
  VISMAP_CHECK_RANGE(check, options.max_incidence_deg, 10, 89.9);
  VISMAP_CHECK_ODD(check, options.window_px, 3, 63);
  VISMAP_CHECK_RANGE(check, options.window_depth_ratio, 1e-4, 1);
  check.Add("noise_", Validate(options.noise));
  return std::move(check).problems();
}

}  // namespace vismap
