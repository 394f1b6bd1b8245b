#include "mapping/thin_hits.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace vismap {
namespace {

constexpr int kStrip = 64;   // rows or columns that are searched together
constexpr int kMostGap = 8;  // pixels without return between a thing and what is beside it

/// Pixels side by side in one line.
struct PixelRun {
  int begin = 0, end = 0;
};

/// The search along one row or column.
struct LineSearch {
  int begin = -1;  // the first pixel since depth became nearer; -1 = it did not
  int last = -kMostGap - 1;
  float depth = 0;  // of pixel `last`

  // Takes a pixel that its neighbour before leads to.
  void Pass(int pixel, float z) {
    if (!(z > 0)) return;
    last = pixel;
    depth = z;
  }
};

/// When pixels are of something thin [m].
class ThinRule {
 public:
  explicit ThinRule(const ThinOptions& options)
      : noise_(options.noise),
        width_(static_cast<float>(2 * options.voxel_size)),
        min_range_(static_cast<float>(options.min_range)),
        max_range_(static_cast<float>(std::min(options.max_range, RangeOfNoise(options)))) {}

  float width() const { return width_; }

  // Takes the next pixel of a line with depth `z`; the focal length is in pixels. Returns a thin
  // run that ends before it; empty = none does.
  PixelRun Advance(LineSearch& search, int pixel, float z, float focal) const {
    PixelRun run;
    if (!(z > 0)) return run;
    const bool close = pixel - search.last <= kMostGap;
    if (!close) {
      search.begin = -1;
    } else if (z < search.depth) {
      if (IsStep(search.depth - z, z)) search.begin = pixel;
    } else if (search.begin >= 0 && IsStep(z - search.depth, search.depth)) {
      const int end = search.last + 1;
      if (IsThin(search.depth, end - search.begin, focal)) run = {search.begin, end};
      search.begin = -1;
    }
    search.last = pixel;
    search.depth = z;
    return run;
  }

 private:
  // From here on the noise exceeds a voxel.
  static double RangeOfNoise(const ThinOptions& options) {
    double z = options.min_range;
    while (z < options.max_range && options.noise.AxialSigma(z) <= options.voxel_size) z += 0.01;
    return z;
  }
  // Whether something at depth `z` and what is so much farther are two things.
  bool IsStep(float farther, float z) const {
    return farther >= width_ &&
           farther >= 4 * static_cast<float>(noise_.AxialSigma(static_cast<double>(z)));
  }
  bool IsThin(float z, int pixels, float focal) const {
    return z >= min_range_ && z <= max_range_ && static_cast<float>(pixels) * z <= width_ * focal;
  }

  const DepthNoiseModel& noise_;
  float width_, min_range_, max_range_;
};

/// Turns pixels into the voxels that their depth ends in.
class HitFinder {
 public:
  HitFinder(const FrameHeader& header, const Image<float>& depth, double voxel_size)
      : header_(header), depth_(depth), voxel_size_(voxel_size) {}

  ThinHit At(int v, int u) const {
    const Eigen::Vector3d p_W =
        header_.T_W_C * header_.camera.BackProject(u, v, static_cast<double>(depth_(v, u)));
    const Eigen::Vector3d cell = (p_W / voxel_size_).array().floor();
    const VoxelIndex voxel{static_cast<int32_t>(cell.x()), static_cast<int32_t>(cell.y()),
                           static_cast<int32_t>(cell.z())};
    return {BlockOf(voxel), OffsetInBlock(voxel)};
  }

 private:
  const FrameHeader& header_;
  const Image<float>& depth_;
  double voxel_size_;
};

/// Calls visit(i) for all i in [0, count), ascending, where `now` or `before` has no depth or the
/// two differ by at least `width` [m]. Most of an image is smooth, so that this skips it.
template <typename Visit>
void ForSteps(const float* now, const float* before, int count, float width, const Visit& visit) {
  constexpr int kGroup = 16;
  for (int first = 0; first < count; first += kGroup) {
    const int end = std::min(first + kGroup, count);
    int32_t smooth = 0;
    for (int i = first; i < end; ++i) smooth += std::abs(now[i] - before[i]) < width ? 1 : 0;
    if (smooth == end - first) continue;
    for (int i = first; i < end; ++i) {
      if (!(std::abs(now[i] - before[i]) < width)) visit(i);
    }
  }
}

size_t StripsOf(int lines) { return static_cast<size_t>((lines + kStrip - 1) / kStrip); }

}  // namespace

std::vector<ThinHit> FindThinHits(const FrameHeader& header, const Image<float>& depth,
                                  const ThinOptions& options) {
  if (depth.empty()) return {};
  const ThinRule rule(options);
  const HitFinder finder(header, depth, options.voxel_size);
  const auto fx = static_cast<float>(header.camera.fx), fy = static_cast<float>(header.camera.fy);
  const size_t row_strips = StripsOf(depth.height()), column_strips = StripsOf(depth.width());
  std::vector<std::vector<ThinHit>> parts(row_strips + column_strips);
  const auto search_rows = [&](int first, std::vector<ThinHit>& hits) {
    for (int v = first; v < std::min(first + kStrip, depth.height()); ++v) {
      const float* row = depth.row(v);
      LineSearch search;
      rule.Advance(search, 0, row[0], fx);
      ForSteps(row + 1, row, depth.width() - 1, rule.width(), [&](int before) {
        search.Pass(before, row[before]);
        const PixelRun run = rule.Advance(search, before + 1, row[before + 1], fx);
        for (int i = run.begin; i < run.end; ++i) {
          if (row[i] > 0) hits.push_back(finder.At(v, i));
        }
      });
    }
  };
  // Row by row, since the pixels of a column are far apart in memory.
  const auto search_columns = [&](int first, std::vector<ThinHit>& hits) {
    std::vector<LineSearch> searches(kStrip);
    const int end = std::min(first + kStrip, depth.width());
    for (int u = first; u < end; ++u)
      rule.Advance(searches[static_cast<size_t>(u - first)], 0, depth(0, u), fy);
    for (int v = 1; v < depth.height(); ++v) {
      const float *now = depth.row(v) + first, *before = depth.row(v - 1) + first;
      ForSteps(now, before, end - first, rule.width(), [&](int column) {
        LineSearch& search = searches[static_cast<size_t>(column)];
        search.Pass(v - 1, before[column]);
        const PixelRun run = rule.Advance(search, v, now[column], fy);
        for (int i = run.begin; i < run.end; ++i) {
          if (depth(i, first + column) > 0) hits.push_back(finder.At(i, first + column));
        }
      });
    }
  };
  ParallelFor(parts.size(), 1, [&](size_t i) {
    if (i < row_strips) {
      search_rows(static_cast<int>(i) * kStrip, parts[i]);
    } else {
      search_columns(static_cast<int>(i - row_strips) * kStrip, parts[i]);
    }
  });
  std::vector<ThinHit> hits;
  for (const std::vector<ThinHit>& part : parts) hits.insert(hits.end(), part.begin(), part.end());
  std::sort(hits.begin(), hits.end());
  hits.erase(std::unique(hits.begin(), hits.end()), hits.end());
  return hits;
}

}  // namespace vismap
