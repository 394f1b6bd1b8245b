#include "mapping/clear_depth.h"

#include <algorithm>

#include "base/parallel.h"

namespace vismap {
namespace {

// The depth less the margin, at least 0.
float LessMargin(float depth, const ClearDepthOptions& options) {
  const auto sigma = static_cast<float>(options.noise.AxialSigma(static_cast<double>(depth)));
  return std::max(depth - std::max(options.margin, options.sigmas * sigma), 0.0F);
}

// The nearest depth in a tile and those around it; 0 = nothing is sure, see ClearDepth.
float NearestAround(const Image<DepthRange>& tiles, int x, int y) {
  if (!tiles(y, x).complete) return 0;
  float nearest = tiles(y, x).nearest;
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, tiles.height() - 1); ++j) {
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, tiles.width() - 1); ++i) {
      if (!(tiles(j, i).nearest <= tiles(j, i).farthest)) return 0;  // no return at all
      nearest = std::min(nearest, tiles(j, i).nearest);
    }
  }
  return nearest;
}

}  // namespace

Image<float> ClearDepth(const DepthPyramid& pyramid, int width, int height,
                        const ClearDepthOptions& options) {
  constexpr int kSide = 1 << DepthPyramid::kTileShift;
  const Image<DepthRange>& tiles = pyramid.tiles();
  Image<float> clear(width, height);
  ParallelFor(static_cast<size_t>(tiles.height()), 4, [&](size_t row) {
    const int y = static_cast<int>(row), v0 = y * kSide;
    float* first = clear.row(v0);
    for (int x = 0; x < tiles.width(); ++x) {
      const float nearest = NearestAround(tiles, x, y);
      std::fill(first + x * kSide, first + std::min((x + 1) * kSide, width),
                nearest > 0 ? LessMargin(nearest, options) : 0.0F);
    }
    for (int v = v0 + 1; v < std::min(v0 + kSide, height); ++v)
      std::copy(first, first + width, clear.row(v));
  });
  return clear;
}

}  // namespace vismap
