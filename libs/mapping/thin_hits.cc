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
};

/// When pixels are of something thin [m].
class ThinRule {
 public:
  explicit ThinRule(const ThinOptions& options)
      : noise_(options.noise),
        width_(static_cast<float>(2 * options.voxel_size)),
        min_range_(static_cast<float>(options.min_range)),
        max_range_(static_cast<float>(std::min(options.max_range, RangeOfNoise(options)))) {}

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

size_t StripsOf(int lines) { return static_cast<size_t>((lines + kStrip - 1) / kStrip); }

}  // namespace

std::vector<ThinHit> FindThinHits(const FrameHeader& header, const Image<float>& depth,
                                  const ThinOptions& options) {
  const ThinRule rule(options);
  const HitFinder finder(header, depth, options.voxel_size);
  const auto fx = static_cast<float>(header.camera.fx), fy = static_cast<float>(header.camera.fy);
  const size_t row_strips = StripsOf(depth.height()), column_strips = StripsOf(depth.width());
  std::vector<std::vector<ThinHit>> parts(row_strips + column_strips);
  const auto search_rows = [&](int first, std::vector<ThinHit>& hits) {
    for (int v = first; v < std::min(first + kStrip, depth.height()); ++v) {
      const float* row = depth.row(v);
      LineSearch search;
      for (int u = 0; u < depth.width(); ++u) {
        const PixelRun run = rule.Advance(search, u, row[u], fx);
        for (int i = run.begin; i < run.end; ++i) {
          if (row[i] > 0) hits.push_back(finder.At(v, i));
        }
      }
    }
  };
  // Row by row, since the pixels of a column are far apart in memory.
  const auto search_columns = [&](int first, std::vector<ThinHit>& hits) {
    std::vector<LineSearch> searches(kStrip);
    const int end = std::min(first + kStrip, depth.width());
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = first; u < end; ++u) {
        const PixelRun run =
            rule.Advance(searches[static_cast<size_t>(u - first)], v, depth(v, u), fy);
        for (int i = run.begin; i < run.end; ++i) {
          if (depth(i, u) > 0) hits.push_back(finder.At(i, u));
        }
      }
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
