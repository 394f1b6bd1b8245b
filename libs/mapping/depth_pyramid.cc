#include "mapping/depth_pyramid.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"

namespace vismap {
namespace {

// At most this many tiles plus one are read along an axis: more tiles bound tighter, but take
// longer.
constexpr int kMaxSpan = 4;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr DepthRange kNothing{kInfinity, -kInfinity, true};

void Include(const DepthRange& other, DepthRange& range) {
  range.nearest = std::min(range.nearest, other.nearest);
  range.farthest = std::max(range.farthest, other.farthest);
  range.complete = range.complete && other.complete;
}

DepthRange TileRange(const Image<float>& depth, int u_begin, int v_begin, int side) {
  DepthRange range = kNothing;
  for (int v = v_begin; v < std::min(depth.height(), v_begin + side); ++v) {
    const float* row = depth.row(v);
    for (int u = u_begin; u < std::min(depth.width(), u_begin + side); ++u) {
      const float z = row[u];
      if (z > 0) {  // false for NaN
        range.nearest = std::min(range.nearest, z);
        range.farthest = std::max(range.farthest, z);
      } else {
        range.complete = false;
      }
    }
  }
  return range;
}

}  // namespace

DepthPyramid::DepthPyramid(const Image<float>& depth) {
  constexpr int kSide = 1 << kTileShift;
  Image<DepthRange> tiles((depth.width() + kSide - 1) / kSide, (depth.height() + kSide - 1) / kSide,
                          kNothing);
  ParallelFor(static_cast<size_t>(tiles.height()), 4, [&](size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < tiles.width(); ++x)
      tiles(y, x) = TileRange(depth, x * kSide, y * kSide, kSide);
  });
  levels_.push_back(std::move(tiles));
  while (levels_.back().width() > 2 || levels_.back().height() > 2) {
    const Image<DepthRange>& fine = levels_.back();
    Image<DepthRange> coarse((fine.width() + 1) / 2, (fine.height() + 1) / 2, kNothing);
    for (int y = 0; y < fine.height(); ++y) {
      for (int x = 0; x < fine.width(); ++x) Include(fine(y, x), coarse(y / 2, x / 2));
    }
    levels_.push_back(std::move(coarse));
  }
}

DepthRange DepthPyramid::Bound(int u0, int v0, int u1, int v1) const {
  int shift = kTileShift;
  size_t level = 0;
  while (level + 1 < levels_.size() &&
         ((u1 >> shift) - (u0 >> shift) > kMaxSpan || (v1 >> shift) - (v0 >> shift) > kMaxSpan)) {
    ++shift;
    ++level;
  }
  DepthRange range = kNothing;
  for (int y = v0 >> shift; y <= v1 >> shift; ++y) {
    for (int x = u0 >> shift; x <= u1 >> shift; ++x) Include(levels_[level](y, x), range);
  }
  return range;
}

}  // namespace vismap
