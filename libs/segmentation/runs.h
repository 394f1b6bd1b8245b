#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "geometry/image.h"
#include "segmentation/pixel_kernels.h"

namespace vismap {

/// Rows of an image that a thread processes at a time, where they are painted by runs.
inline constexpr size_t kRunRowGrain = 16;

/// Working image of SegmentDepth: the number of the region that each pixel belongs to; 0 = none.
using RegionImage = Image<int32_t>;

/// The pixels [begin, end) of row v, all of one region. An image has far fewer runs than pixels, so
/// that work per run is cheap.
struct Run {
  int32_t v = 0, begin = 0, end = 0;
  int32_t region = 0;

  int32_t length() const { return end - begin; }
};

/// All runs of an image, row by row, from left to right.
class RunTable {
 public:
  /// Finds the runs of an image. `mark(v, flags)` fills the flags of row v; it is called from
  /// several threads.
  RunTable(int width, int height, const std::function<void(int, RunFlags)>& mark);

  std::vector<Run>& runs() { return runs_; }
  const std::vector<Run>& runs() const { return runs_; }
  int height() const { return static_cast<int>(row_begin_.size()) - 1; }
  std::span<const Run> row(int v) const {
    const auto at = static_cast<size_t>(v);
    return {runs_.data() + row_begin_[at], runs_.data() + row_begin_[at + 1]};
  }

 private:
  std::vector<Run> runs_;
  std::vector<size_t> row_begin_{0};
};

/// Calls visit(upper, lower, begin, end) for every two runs of neighbouring rows that share the
/// columns [begin, end), from left to right.
template <typename Visit>
void ForOverlaps(std::span<const Run> upper, std::span<const Run> lower, const Visit& visit) {
  size_t a = 0, b = 0;
  while (a < upper.size() && b < lower.size()) {
    const int32_t begin = std::max(upper[a].begin, lower[b].begin);
    const int32_t end = std::min(upper[a].end, lower[b].end);
    if (begin < end) visit(upper[a], lower[b], begin, end);
    if (upper[a].end < lower[b].end) {
      ++a;
    } else {
      ++b;
    }
  }
}

}  // namespace vismap
