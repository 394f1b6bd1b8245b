#include "segmentation/split_segments.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace vismap {
namespace {

/// A number of pixels at 640x480 as one of this image, by its area.
int32_t Scaled(int pixels_at_vga, const Image<SegmentIndex>& image) {
  const double area = static_cast<double>(image.width()) * image.height() / (640.0 * 480.0);
  return std::max(1, static_cast<int32_t>(std::lround(pixels_at_vga * area)));
}

/// The segment that the detection of this rank splits; nullopt = none.
std::optional<size_t> FindSegmentToSplit(const SegmentCounts& counts, size_t rank,
                                         const RefineOptions& options) {
  const std::vector<int32_t>& inside = counts.inside[rank];
  if (inside.empty()) return std::nullopt;  // the frame has no segment
  const auto most = std::max_element(inside.begin(), inside.end());
  const auto segment = static_cast<size_t>(most - inside.begin());
  const int32_t pixels = counts.pixels[segment];
  const int32_t mask_pixels = std::accumulate(inside.begin(), inside.end(), 0);
  const bool splits = *most >= Scaled(options.split_min_px, counts.image.index) &&
                      pixels - *most >= Scaled(options.split_min_rest_px, counts.image.index) &&
                      *most >= options.split_min_mask_part * mask_pixels &&
                      // Above this, the detection gets the whole segment.
                      *most <= options.min_overlap * pixels;
  return splits ? std::optional(segment) : std::nullopt;
}

/// Moves the pixels of `segment` that belong to the detection of this rank to a new segment.
void CutOut(size_t segment, size_t rank, const PixelOwnership& ownership, SegmentCounts* counts) {
  const auto old_index = static_cast<SegmentIndex>(segment);
  const auto new_index = static_cast<SegmentIndex>(counts->image.segment_count++);
  ownership.ForPixelsOf(ownership.ranking()[rank], [&](int v, int u) {
    SegmentIndex& pixel = counts->image.index(v, u);
    if (pixel == old_index) pixel = new_index;
  });
  std::vector<int32_t>& inside = counts->inside[rank];
  counts->pixels[segment] -= inside[segment];
  counts->pixels.push_back(inside[segment]);
  inside.resize(counts->pixels.size());
  inside.back() = std::exchange(inside[segment], 0);
}

}  // namespace

SegmentCounts SplitSegments(SegmentCounts counts, const PixelOwnership& ownership,
                            const RefineOptions& options) {
  for (size_t rank = 0; rank < ownership.ranking().size(); ++rank) {
    const DetectionIndex k = ownership.ranking()[rank];
    if (ownership.detection(k).score < options.split_min_score) continue;
    const std::optional<size_t> segment = FindSegmentToSplit(counts, rank, options);
    if (!segment) continue;
    CutOut(*segment, rank, ownership, &counts);
    // The pixels that moved may belong to other detections as well.
    if (ownership.is_shared()) CountInside(ownership, &counts);
  }
  return counts;
}

}  // namespace vismap
