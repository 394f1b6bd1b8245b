#include "geometry/smooth_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "base/require.h"
#include "geometry/vector_clones.h"

namespace vismap {
namespace {

constexpr size_t kSmoothGrain = 16;
constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

// The noise model in single precision, and the factor of the limit.
struct Limit {
  float base, quadratic, offset, step_variance, scale;
};

// Lines of inverse depth [1/m]: `before[k]` and `after[k]` lie k + 1 pixels away on both sides.
struct Lines {
  const float* middle;
  std::array<const float*, kMostSmoothRadius> before, after;
};

VISMAP_VECTOR_CLONES void Invert(const float* from, int count, float* __restrict to) {
  for (int i = 0; i < count; ++i) to[i] = 1.0F / from[i];
}

// Where a pair ends the window, `open` becomes 0 for the rest of it. Comparisons with NaN are
// false.
VISMAP_VECTOR_CLONES void AddPair(const float* middle, const float* before, const float* after,
                                  const float* limit, int count, float* __restrict open,
                                  float* __restrict sum, float* __restrict number) {
  for (int i = 0; i < count; ++i) {
    const float pair = before[i] + after[i];
    const float bend = std::abs(pair - 2.0F * middle[i]);
    const float joined = bend <= limit[i] ? open[i] : 0.0F;
    sum[i] += joined > 0 ? pair : 0.0F;
    number[i] += 2.0F * joined;
    open[i] = joined;
  }
}

VISMAP_VECTOR_CLONES void FindLimits(const float* middle, const Limit& noise, int count,
                                     float* __restrict limits) {
  const float base = noise.base, quadratic = noise.quadratic, offset = noise.offset;
  const float step_variance = noise.step_variance, scale = noise.scale;
  for (int i = 0; i < count; ++i) {
    const float w = middle[i];
    const float beyond = 1.0F / w - offset;
    const float past = beyond > 0 ? beyond : 0.0F;
    const float sigma = (base + quadratic * past * past) * (w * w);
    limits[i] = scale * std::sqrt(sigma * sigma + step_variance);
  }
}

VISMAP_VECTOR_CLONES void Divide(const float* sum, const float* number, int count,
                                 float* __restrict mean) {
  for (int i = 0; i < count; ++i) mean[i] = sum[i] / number[i];
}

// Memory of one line.
struct Sums {
  std::vector<float> limit, open, sum, number;

  explicit Sums(int count)
      : limit(static_cast<size_t>(count)), open(limit), sum(limit), number(limit) {}
};

void SmoothLine(const Lines& lines, const Limit& noise, int radius, int count, Sums& sums,
                float* out) {
  FindLimits(lines.middle, noise, count, sums.limit.data());
  std::fill(sums.open.begin(), sums.open.end(), 1.0F);
  std::fill(sums.number.begin(), sums.number.end(), 1.0F);
  std::copy_n(lines.middle, count, sums.sum.begin());
  for (size_t k = 0; k < static_cast<size_t>(radius); ++k) {
    AddPair(lines.middle, lines.before[k], lines.after[k], sums.limit.data(), count,
            sums.open.data(), sums.sum.data(), sums.number.data());
  }
  Divide(sums.sum.data(), sums.number.data(), count, out);
}

// Along a row: the lines are the row itself, shifted, in a copy with `radius` pixels without depth
// on both sides.
void SmoothRow(const float* depth, const Limit& noise, int radius, int width, float* out) {
  std::vector<float> padded(static_cast<size_t>(width + 2 * radius), kNoDepth);
  Invert(depth, width, padded.data() + radius);
  Lines lines{.middle = padded.data() + radius, .before = {}, .after = {}};
  for (int k = 0; k < radius; ++k) {
    lines.before[static_cast<size_t>(k)] = lines.middle - (k + 1);
    lines.after[static_cast<size_t>(k)] = lines.middle + (k + 1);
  }
  Sums sums(width);
  SmoothLine(lines, noise, radius, width, sums, out);
}

// Along the columns, for all pixels of row v.
void SmoothColumns(const Image<float>& rows, const std::vector<float>& none, const Limit& noise,
                   int radius, int v, float* out) {
  const int width = rows.width();
  const auto row = [&](int at) {
    return at >= 0 && at < rows.height() ? rows.row(at) : none.data();
  };
  Lines lines{.middle = rows.row(v), .before = {}, .after = {}};
  for (int k = 0; k < radius; ++k) {
    lines.before[static_cast<size_t>(k)] = row(v - k - 1);
    lines.after[static_cast<size_t>(k)] = row(v + k + 1);
  }
  Sums sums(width);
  std::vector<float> smooth(static_cast<size_t>(width));
  SmoothLine(lines, noise, radius, width, sums, smooth.data());
  Invert(smooth.data(), width, out);
}

}  // namespace

Image<float> SmoothDepth(const Image<float>& depth, const DepthNoiseModel& noise,
                         const DepthSmoothing& options) {
  const int radius = options.radius_px, width = depth.width(), height = depth.height();
  Require(radius >= 0 && radius <= kMostSmoothRadius, "depth is smoothed over 0 to 8 pixels");
  if (radius == 0) return depth;
  const Limit limit{.base = static_cast<float>(noise.axial_base_m),
                    .quadratic = static_cast<float>(noise.axial_quadratic_per_m),
                    .offset = static_cast<float>(noise.axial_offset_m),
                    .step_variance = static_cast<float>(noise.disparity_step_per_m *
                                                        noise.disparity_step_per_m / 12),
                    .scale = static_cast<float>(options.sigmas * std::sqrt(6.0))};
  Image<float> rows = Image<float>::Unset(width, height), out = Image<float>::Unset(width, height);
  ParallelFor(static_cast<size_t>(height), kSmoothGrain, [&](size_t v) {
    const int row = static_cast<int>(v);
    SmoothRow(depth.row(row), limit, radius, width, rows.row(row));
  });
  const std::vector<float> none(static_cast<size_t>(width), kNoDepth);
  ParallelFor(static_cast<size_t>(height), kSmoothGrain, [&](size_t v) {
    const int row = static_cast<int>(v);
    SmoothColumns(rows, none, limit, radius, row, out.row(row));
  });
  return out;
}

}  // namespace vismap
