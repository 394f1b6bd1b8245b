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
  kNoiseScaled,  ///< ours: edges in units of the sensor's noise, given back by a flood
  kPublished,    ///< the published code's fixed thresholds; slow, and shatters beyond 3 m
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
  double concave_angle_deg = 16;  ///< a concave fold is an edge from here on [deg] ...
  double concave_sigmas = 3.0;    ///< ... and from this multiple of the normals' error
  double sharp_angle_deg = 50;  ///< a concave fold is an edge from here on whatever the noise [deg]
  int min_seed_px = 60;         ///< flat areas smaller than this start no segment [px at 640x480]
  double coplanar_sigmas = 1.5;  ///< neighbours on one plane within this many sigma are joined
  double join_angle_deg = 20;    ///< a small segment joins its one neighbour if this parallel [deg]

  // kPublished (Grinvald 2019; constants of the published code)
  double depth_ratio = 0.01;            ///< depth step over z from which a pixel is an edge
  double concave_tolerance_m = 0.0005;  ///< points that rise less are not concave [m]
  double concave_cosine = 0.97;         ///< concave neighbours with normals farther apart are edges
  int convexity_window_px = 5;          ///< side of the window looked at [px], odd
  int give_back_window_px = 9;          ///< edge pixels search this window for a segment [px], odd
  double give_back_distance_m = 0.05;   ///< and join the nearest point within [m]
};

/// Options of RefineWithDetections.
struct RefineOptions {
  double min_overlap = 0.7;      ///< tau_p: a mask must cover more than this part of a segment
  double min_score = 0.0;        ///< detections below are ignored, as if they were not there
  bool resolve_overlaps = true;  ///< a pixel in several masks belongs only to the best one
  /// A mask of which more than this part lies in another one of its class, at most three times as
  /// large, is a second detection of the same thing; 1 = off. Needs resolve_overlaps.
  double same_part = 0.7;
  /// Segments farther behind or before the largest one of their mask than this times the mask's
  /// larger side in metres are seen through gaps of the object, or hide it: they get no detection.
  /// 0 = off.
  double max_depth_extent = 1.5;
  /// Pieces too small to be segments, such as a chair's legs, go to the object whose mask covers
  /// more than min_overlap of them.
  bool take_loose = true;
  /// The same as max_depth_extent for such pieces: less, as gaps between the slats of a chair show
  /// many pieces of what is behind it; 0 = off.
  double loose_depth_extent = 1.0;
  /// Pixels on a fold go to the object whose mask they lie in, if they hang together with it; only
  /// masks with at least this score take any. Above 1 = off.
  double fold_min_score = 0.5;
  bool split = true;                 ///< good masks may split segments
  double split_min_score = 0.35;     ///< only masks with at least this score split
  double split_min_mask_part = 0.7;  ///< part of the mask that must lie in the one segment
  int split_min_px = 300;            ///< of the part cut out [px at 640x480, scaled by area]
  int split_min_rest_px = 500;       ///< of the part left [px at 640x480, scaled by area]
  /// Detections of these classes are taken out of the frame: things that move, such as people.
  std::vector<ClassId> leave_out_classes;
  int leave_out_margin_px = 6;  ///< their masks are grown by this first [px at 640 wide, scaled]
};

/// Options of the whole stage: depth image in, segmented frame out.
struct SegmentationStageOptions {
  SurfaceOptions surface;
  SegmentationOptions segmentation;
  RefineOptions refine;
};

/// All that is wrong with the options, one sentence each; empty = nothing.
std::vector<std::string> Validate(const SegmentationOptions& options);
std::vector<std::string> Validate(const RefineOptions& options);
std::vector<std::string> Validate(const SegmentationStageOptions& options);

}  // namespace vismap
