#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "base/ids.h"
#include "geometry/surface_options.h"

namespace vismap {

/// How a depth image is cut into segments.
enum class SegmentationMethod {
  kNoiseScaled,  ///< ours: thresholds in units of the noise, edge pixels assigned by a flood
  kPublished,    ///< fixed thresholds of the published code; slow, and surfaces beyond 3 m shatter
};

inline constexpr auto NamesOf(SegmentationMethod) {
  return std::to_array<EnumName<SegmentationMethod>>(
      {{"NOISE_SCALED", SegmentationMethod::kNoiseScaled},
       {"PUBLISHED", SegmentationMethod::kPublished}});
}

/// Options of SegmentDepth.
struct SegmentationOptions {
  SegmentationMethod method = SegmentationMethod::kNoiseScaled;
  int min_segment_px = 500;  ///< smaller segments are dropped [px at 640x480, scaled by area]

  // kNoiseScaled
  /// A concave fold is an edge when its angle is at least concave_angle_deg and concave_sigmas
  /// standard deviations of the normals, or at least sharp_angle_deg.
  double concave_angle_deg = 16;
  double concave_sigmas = 3.0;
  double sharp_angle_deg = 50;
  int min_seed_px = 60;          ///< smaller flat areas start no segment [px at 640x480]
  double coplanar_sigmas = 1.5;  ///< see JoinCoplanarRegions; 0 = off
  double join_angle_deg = 20;    ///< largest angle between a small segment and its host [deg]

  // kPublished (Grinvald 2019; constants of the published code)
  double depth_ratio = 0.01;            ///< larger depth steps, relative to z, are edges
  double concave_tolerance_m = 0.0005;  ///< points that rise less are not concave [m]
  double concave_cosine = 0.97;         ///< concave neighbours with a smaller n . n' are edges
  int convexity_window_px = 5;          ///< side of the window of the concavity test [px], odd
  int give_back_window_px = 9;          ///< window in which edge pixels search a segment [px], odd
  double give_back_distance_m = 0.05;   ///< largest distance to the segment's nearest point [m]
};

/// Options of RefineWithDetections.
struct RefineOptions {
  double min_overlap = 0.7;      ///< τ_p: a mask must cover more than this part of a segment
  double min_score = 0.0;        ///< detections with a lower score are ignored
  bool resolve_overlaps = true;  ///< a pixel in several masks belongs to the best one only
  /// Two masks of one class are detections of one thing when more than this part of the smaller
  /// one lies in the other one, which is at most three times as large; 1 = off. Has an effect only
  /// with resolve_overlaps.
  double same_part = 0.7;
  /// A segment gets no detection when it is farther in front of or behind the largest segment of
  /// the mask than this times the mask's larger side [m]: it is seen through a gap of the object,
  /// or hides it. 0 = off.
  double max_depth_extent = 1.5;
  /// Loose pieces, which are too small to be segments, such as the legs of a chair, go to the
  /// object whose mask covers more than min_overlap of them.
  bool take_loose = true;
  /// max_depth_extent for loose pieces. It is smaller, since the gaps between the slats of a chair
  /// show many loose pieces of the surface behind it; 0 = off.
  double loose_depth_extent = 1.0;
  /// Pixels on a fold go to the object whose mask contains them, if they are connected with it and
  /// the detection has at least this score. Above 1 = off.
  double fold_min_score = 0.5;
  bool split = true;                 ///< good masks may split segments, see SplitSegments
  double split_min_score = 0.35;     ///< only detections with at least this score split
  double split_min_mask_part = 0.7;  ///< part of the mask that must lie in the split segment
  int split_min_px = 300;       ///< smallest part that is cut out [px at 640x480, scaled by area]
  int split_min_rest_px = 500;  ///< smallest part that stays [px at 640x480, scaled by area]
  /// The pixels of detections of these classes are removed: things that move, such as people.
  std::vector<ClassId> leave_out_classes;
  int leave_out_margin_px = 6;  ///< the masks are grown by this first [px at width 640, scaled]
};

/// Options of the whole stage: depth image in, segmented frame out.
struct SegmentationStageOptions {
  SurfaceOptions surface;
  SegmentationOptions segmentation;
  RefineOptions refine;
};

/// The problems of the options, one sentence each; empty = they are valid.
std::vector<std::string> Validate(const SegmentationOptions& options);
std::vector<std::string> Validate(const RefineOptions& options);
std::vector<std::string> Validate(const SegmentationStageOptions& options);

}  // namespace vismap
