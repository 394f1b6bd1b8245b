#include "segmentation/segment_counts.h"

#include <utility>

#include "base/parallel.h"
#include "segmentation/at.h"

namespace vismap {
RunTable SegmentRuns(const Image<SegmentIndex>& index) {
  return {index.width(), index.height(),
          [&index](int v, RunFlags flags) { MarkSegments(index.row(v), index.width(), flags); }};
}

std::vector<int32_t> CountPixels(const SegmentImage& image) {
  std::vector<int32_t> pixels(At(image.segment_count));
  const RunTable table = SegmentRuns(image.index);
  for (const Run& run : table.runs()) pixels[At(image.index(run.v, run.begin))] += run.length();
  return pixels;
}

void CountInside(const PixelOwnership& ownership, SegmentCounts* counts) {
  const std::vector<DetectionIndex>& ranking = ownership.ranking();
  counts->inside.resize(ranking.size());
  ParallelFor(ranking.size(), 1, [&](size_t rank) {
    std::vector<int32_t> inside(counts->pixels.size());
    ownership.ForPixelsOf(ranking[rank], [&](int v, int u) {
      const SegmentIndex segment = counts->image.index(v, u);
      if (segment != SegmentIndex::kNone) ++inside[At(segment)];
    });
    counts->inside[rank] = std::move(inside);
  });
}

SegmentCounts CountSegments(SegmentImage image, const PixelOwnership& ownership) {
  SegmentCounts counts{std::move(image), {}, {}};
  counts.pixels = CountPixels(counts.image);
  CountInside(ownership, &counts);
  return counts;
}

}  // namespace vismap
