#include "segmentation/segmentation_options.h"

#include "base/option_check.h"

namespace vismap {

std::vector<std::string> Validate(const SegmentationOptions& options) {
  OptionCheck check;
  VISMAP_CHECK_AT_LEAST(check, options.min_segment_px, 1);
  VISMAP_CHECK_RANGE(check, options.concave_angle_deg, 1, 90);
  VISMAP_CHECK_RANGE(check, options.concave_sigmas, 0, 100);
  VISMAP_CHECK_RANGE(check, options.sharp_angle_deg, 1, 180);
  VISMAP_CHECK_AT_LEAST(check, options.min_seed_px, 1);
  VISMAP_CHECK_RANGE(check, options.coplanar_sigmas, 0, 100);
  VISMAP_CHECK_RANGE(check, options.join_angle_deg, 0, 180);
  VISMAP_CHECK_RANGE(check, options.depth_ratio, 1e-5, 1);
  VISMAP_CHECK_RANGE(check, options.concave_tolerance_m, 0, 1);
  VISMAP_CHECK_RANGE(check, options.concave_cosine, -1, 1);
  VISMAP_CHECK_ODD(check, options.convexity_window_px, 3, 63);
  VISMAP_CHECK_ODD(check, options.give_back_window_px, 3, 63);
  VISMAP_CHECK_RANGE(check, options.give_back_distance_m, 0, 10);
  return std::move(check).problems();
}

std::vector<std::string> Validate(const RefineOptions& options) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, options.min_overlap, 0, 1);
  VISMAP_CHECK_RANGE(check, options.same_part, 0, 1);
  VISMAP_CHECK_RANGE(check, options.min_score, 0, 1);
  VISMAP_CHECK_RANGE(check, options.max_depth_extent, 0, 100);
  VISMAP_CHECK_RANGE(check, options.loose_depth_extent, 0, 100);
  VISMAP_CHECK_RANGE(check, options.fold_min_score, 0, 2);
  VISMAP_CHECK_RANGE(check, options.split_min_score, 0, 1);
  VISMAP_CHECK_RANGE(check, options.split_min_mask_part, 0, 1);
  VISMAP_CHECK_AT_LEAST(check, options.split_min_px, 1);
  VISMAP_CHECK_AT_LEAST(check, options.split_min_rest_px, 1);
  VISMAP_CHECK_RANGE(check, options.leave_out_margin_px, 0, 100);
  return std::move(check).problems();
}

std::vector<std::string> Validate(const SegmentationStageOptions& options) {
  OptionCheck check;
  check.Add("surface.", Validate(options.surface));
  check.Add("segmentation.", Validate(options.segmentation));
  check.Add("refine.", Validate(options.refine));
  return std::move(check).problems();
}

}  // namespace vismap
