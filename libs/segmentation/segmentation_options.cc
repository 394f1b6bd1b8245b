#include "segmentation/segmentation_options.h"

#include <iterator>

namespace vismap {
namespace {

/// Collects a sentence for every condition that does not hold.
class Problems {
 public:
  void Unless(bool ok, const char* sentence) {
    if (!ok) list_.emplace_back(sentence);
  }
  void Add(const std::string& prefix, const std::vector<std::string>& list) {
    for (const std::string& problem : list) list_.push_back(prefix + problem);
  }
  std::vector<std::string> list() && { return std::move(list_); }

 private:
  std::vector<std::string> list_;
};

bool InRange(double x, double low, double high) { return x >= low && x <= high; }  // false for NaN
bool OddWindow(int side) { return side >= 3 && side <= 63 && side % 2 == 1; }

}  // namespace

std::vector<std::string> Validate(const SegmentationOptions& options) {
  Problems problems;
  problems.Unless(options.min_segment_px >= 1, "min_segment_px must be at least 1");
  problems.Unless(InRange(options.concave_angle_deg, 1, 90),
                  "concave_angle_deg must be in [1, 90]");
  problems.Unless(InRange(options.concave_sigmas, 0, 100), "concave_sigmas must be in [0, 100]");
  problems.Unless(InRange(options.sharp_angle_deg, 1, 180), "sharp_angle_deg must be in [1, 180]");
  problems.Unless(options.min_seed_px >= 1, "min_seed_px must be at least 1");
  problems.Unless(InRange(options.coplanar_sigmas, 0, 100), "coplanar_sigmas must be in [0, 100]");
  problems.Unless(InRange(options.join_angle_deg, 0, 180), "join_angle_deg must be in [0, 180]");
  problems.Unless(InRange(options.depth_ratio, 1e-5, 1), "depth_ratio must be in [1e-5, 1]");
  problems.Unless(InRange(options.concave_tolerance_m, 0, 1),
                  "concave_tolerance_m must be in [0, 1] m");
  problems.Unless(InRange(options.concave_cosine, -1, 1), "concave_cosine must be in [-1, 1]");
  problems.Unless(OddWindow(options.convexity_window_px),
                  "convexity_window_px must be odd and in [3, 63]");
  problems.Unless(OddWindow(options.give_back_window_px),
                  "give_back_window_px must be odd and in [3, 63]");
  problems.Unless(InRange(options.give_back_distance_m, 0, 10),
                  "give_back_distance_m must be in [0, 10] m");
  return std::move(problems).list();
}

std::vector<std::string> Validate(const RefineOptions& options) {
  Problems problems;
  problems.Unless(InRange(options.min_overlap, 0, 1), "min_overlap must be in [0, 1]");
  problems.Unless(InRange(options.same_part, 0, 1), "same_part must be in [0, 1]");
  problems.Unless(InRange(options.min_score, 0, 1), "min_score must be in [0, 1]");
  problems.Unless(InRange(options.max_depth_extent, 0, 100),
                  "max_depth_extent must be in [0, 100]");
  problems.Unless(InRange(options.loose_depth_extent, 0, 100),
                  "loose_depth_extent must be in [0, 100]");
  problems.Unless(InRange(options.fold_min_score, 0, 2), "fold_min_score must be in [0, 2]");
  problems.Unless(InRange(options.split_min_score, 0, 1), "split_min_score must be in [0, 1]");
  problems.Unless(InRange(options.split_min_mask_part, 0, 1),
                  "split_min_mask_part must be in [0, 1]");
  problems.Unless(options.split_min_px >= 1, "split_min_px must be at least 1");
  problems.Unless(options.split_min_rest_px >= 1, "split_min_rest_px must be at least 1");
  problems.Unless(InRange(options.leave_out_margin_px, 0, 100),
                  "leave_out_margin_px must be in [0, 100]");
  return std::move(problems).list();
}

std::vector<std::string> Validate(const SegmentationStageOptions& options) {
  Problems problems;
  problems.Add("surface.", Validate(options.surface));
  problems.Add("segmentation.", Validate(options.segmentation));
  problems.Add("refine.", Validate(options.refine));
  return std::move(problems).list();
}

}  // namespace vismap
