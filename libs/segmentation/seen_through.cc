#include "segmentation/seen_through.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "segmentation/at.h"
#include "segmentation/segment_counts.h"

namespace vismap {
std::vector<double> MeanDepths(const SegmentedFrame& frame) {
  const RunTable table = SegmentRuns(frame.image.index);
  const std::vector<Run>& runs = table.runs();
  std::vector<double> sums(runs.size());
  ParallelFor(runs.size(), 256, [&](size_t i) {
    const float* depth = frame.frame.depth.row(runs[i].v);
    sums[i] = std::accumulate(depth + runs[i].begin, depth + runs[i].end, 0.0);
  });
  std::vector<double> depths(frame.segments.size());
  for (size_t i = 0; i < runs.size(); ++i)
    depths[At(frame.image.index(runs[i].v, runs[i].begin))] += sums[i];
  for (size_t i = 0; i < depths.size(); ++i) depths[i] /= frame.segments[i].pixels;
  return depths;
}

std::vector<SegmentIndex> LargestSegments(const std::vector<FrameSegment>& segments,
                                          size_t detection_count) {
  std::vector<SegmentIndex> largest(detection_count, SegmentIndex::kNone);
  for (size_t i = 0; i < segments.size(); ++i) {
    if (segments[i].detection == DetectionIndex::kNone) continue;
    SegmentIndex& best = largest[At(segments[i].detection)];
    if (best == SegmentIndex::kNone || segments[i].pixels > segments[At(best)].pixels)
      best = static_cast<SegmentIndex>(i);
  }
  return largest;
}

bool IsWithinExtent(double depth, double object_depth, const Mask& mask,
                    const PinholeCamera& camera, double extent) {
  if (extent <= 0) return true;  // the test is off
  const Image<uint8_t>& box = mask.inside;
  const double side = object_depth * std::max(box.width() / camera.fx, box.height() / camera.fy);
  return std::abs(depth - object_depth) <= extent * side;
}

std::vector<FrameSegment> DropSeenThrough(const SegmentedFrame& frame,
                                          const PixelOwnership& ownership,
                                          const std::vector<double>& depths, double max_extent) {
  std::vector<FrameSegment> segments = frame.segments;
  const std::vector<SegmentIndex> largest = LargestSegments(segments, ownership.detection_count());
  for (size_t i = 0; i < segments.size(); ++i) {
    const DetectionIndex k = segments[i].detection;
    if (k == DetectionIndex::kNone) continue;
    if (!IsWithinExtent(depths[i], depths[At(largest[At(k)])], ownership.MaskOf(k),
                        frame.frame.header.camera, max_extent))
      segments[i] = {.pixels = segments[i].pixels};
  }
  return segments;
}

}  // namespace vismap
