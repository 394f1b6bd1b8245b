#pragma once

#include "segmentation/segmentation_options.h"

namespace vismap::testing_support {

/// The constants and the behaviour of the published code (Grinvald 2019, Sec. III-A and III-B),
/// without those of its errors that would stop it. config/published.txtpb says the same.
inline SegmentationStageOptions PublishedOptions() {
  SegmentationStageOptions options;
  options.surface.method = NormalMethod::kWindowCovariance;
  options.surface.max_hole_px = 0;
  options.segmentation.method = SegmentationMethod::kPublished;
  options.refine.min_overlap = 0.8;
  options.refine.max_depth_extent = 0;
  options.refine.resolve_overlaps = false;
  options.refine.split = false;
  options.refine.take_loose = false;
  options.refine.fold_min_score = 2;
  return options;
}

}  // namespace vismap::testing_support
