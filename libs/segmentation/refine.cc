#include "segmentation/refine.h"

#include <utility>

#include "base/require.h"
#include "segmentation/fold_pixels.h"
#include "segmentation/loose_pieces.h"
#include "segmentation/match_detections.h"
#include "segmentation/pixel_ownership.h"
#include "segmentation/seen_through.h"
#include "segmentation/segment_counts.h"
#include "segmentation/split_segments.h"

namespace vismap {
namespace {

SegmentedFrame WithoutDetector(RgbdFrame frame, SegmentImage image) {
  SegmentedFrame out{std::move(frame), std::move(image), {}, false};
  out.segments = SegmentsWithoutDetection(CountPixels(out.image));
  return out;
}

SegmentedFrame WithDetections(RgbdFrame frame, SegmentImage image, const DetectionSet& detections,
                              const RefineOptions& options) {
  const PixelOwnership ownership(detections, options, image.index.width(), image.index.height());
  SegmentCounts counts = CountSegments(std::move(image), ownership);
  if (options.split) counts = SplitSegments(std::move(counts), ownership, options);
  SegmentedFrame out{std::move(frame), {}, {}, true};
  out.segments = MatchDetections(counts, ownership, options.min_overlap);
  out.image = std::move(counts.image);
  if (detections.detections.empty()) return out;

  const std::vector<double> depths = MeanDepths(out);
  out.segments = DropSeenThrough(out, ownership, depths, options.max_depth_extent);
  if (options.take_loose) out = AttachLoosePieces(std::move(out), ownership, depths, options);
  const bool moves_folds = options.fold_min_score <= 1 && !out.image.edge_strength.empty();
  if (moves_folds) out = AssignFoldPixels(std::move(out), ownership, options.fold_min_score);
  return out;
}

}  // namespace

SegmentedFrame RefineWithDetections(RgbdFrame frame, SegmentImage image,
                                    const DetectionSet* detections, const RefineOptions& options) {
  Require(
      frame.depth.width() == image.index.width() && frame.depth.height() == image.index.height(),
      "a segment image has the size of its frame");
  SegmentedFrame out = detections == nullptr ? WithoutDetector(std::move(frame), std::move(image))
                                             : WithDetections(std::move(frame), std::move(image),
                                                              *detections, options);
  out.image.edge_strength = {};  // only the refinement reads these two
  out.image.loose = {};
  return out;
}

}  // namespace vismap
