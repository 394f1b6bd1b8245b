#include "segmentation/match_detections.h"

namespace vismap {

std::vector<FrameSegment> SegmentsWithoutDetection(const std::vector<int32_t>& pixels) {
  std::vector<FrameSegment> segments;
  segments.reserve(pixels.size());
  for (const int32_t count : pixels) segments.push_back({.pixels = count});
  return segments;
}

std::vector<FrameSegment> MatchDetections(const SegmentCounts& counts,
                                          const PixelOwnership& ownership, double min_overlap) {
  std::vector<FrameSegment> segments = SegmentsWithoutDetection(counts.pixels);
  for (size_t rank = 0; rank < ownership.ranking().size(); ++rank) {
    const DetectionIndex k = ownership.ranking()[rank];
    const std::vector<int32_t>& inside = counts.inside[rank];
    for (size_t i = 0; i < inside.size(); ++i) {
      FrameSegment& segment = segments[i];
      const float overlap = static_cast<float>(inside[i]) / static_cast<float>(segment.pixels);
      if (!(overlap > static_cast<float>(min_overlap))) continue;
      if (overlap <= segment.overlap) continue;  // a better detection covers as much
      segment.detection = k;
      segment.class_id = ownership.detection(k).class_id;
      segment.score = ownership.detection(k).score;
      segment.overlap = overlap;
    }
  }
  return segments;
}

}  // namespace vismap
