#include "rectify/splat_kernels.h"

#include <algorithm>
#include <cmath>

#include "geometry/vector_clones.h"

namespace vismap {
namespace {

// A displacement in the result, and the change of inverse depth over it.
struct Step {
  float x, y, w;
};

inline Step Between(float x0, float y0, float w0, float x1, float y1, float w1) {
  return {x1 - x0, y1 - y0, w1 - w0};
}

inline bool Joined(float a, float b) {
  return (a > 0.0F) & (b > 0.0F) & (std::abs(a - b) <= kMaxJoinedStep * std::min(a, b));
}

inline float Select(bool which, float a, float b) { return which ? a : b; }

// The step to use on a side: its own when joined, else that of the other side, else the nominal
// one.
inline Step Half(bool joined, const Step& own, bool other_joined, const Step& other,
                 float nominal_x, float nominal_y) {
  return {0.5F * Select(joined, own.x, Select(other_joined, other.x, nominal_x)),
          0.5F * Select(joined, own.y, Select(other_joined, other.y, nominal_y)), 0.0F};
}

// The step with the smaller change of inverse depth; no change when the two contradict each other.
inline Step Gentler(bool before_joined, const Step& before, bool after_joined, const Step& after,
                    float nominal_x, float nominal_y) {
  const bool both = before_joined & after_joined;
  const bool use_after = after_joined & (!before_joined | (std::abs(after.w) < std::abs(before.w)));
  const bool use_before = before_joined & !use_after;
  const bool none = both & (before.w * after.w <= 0.0F);
  return {Select(use_after, after.x, Select(use_before, before.x, nominal_x)),
          Select(use_after, after.y, Select(use_before, before.y, nominal_y)),
          Select(none, 0.0F, Select(use_after, after.w, Select(use_before, before.w, 0.0F)))};
}

// NaN becomes `low`: the order of the arguments matters.
inline int32_t Clamped(float value, int32_t low, int32_t high) {
  return static_cast<int32_t>(
      std::min(static_cast<float>(high), std::max(static_cast<float>(low), value)));
}

}  // namespace

VISMAP_VECTOR_CLONES
void ProjectRow(const float* z, const RayRow& rays, int count, const ProjectedRow& out) {
  const RayRow r = rays;
  const ProjectedRow to = out;
#pragma GCC ivdep  // the rows are different images
  for (int u = 0; u < count; ++u) {
    const float depth = z[u] * r.rz[u] + r.tz;
    const float x = z[u] * r.rx[u] + r.tx, y = z[u] * r.ry[u] + r.ty;
    const bool seen = (z[u] > 0.0F) & (z[u] < kFarthestDepth) & (depth > kNearestDepth);
    const float w = 1.0F / std::max(depth, kNearestDepth);
    to.x[u] = Select(seen, x * w, 0.0F);
    to.y[u] = Select(seen, y * w, 0.0F);
    to.w[u] = Select(seen, w, 0.0F);
  }
}

VISMAP_VECTOR_CLONES
void MeasureRow(const ProjectedRow& above, const ProjectedRow& at, const ProjectedRow& below,
                const PixelSteps& steps, int width, int height, int count,
                const FootprintRow& out) {
#pragma GCC ivdep  // the rows are different images
  for (int u = 0; u < count; ++u) {
    const float x = at.x[u], y = at.y[u], w = at.w[u];
    const bool left = Joined(w, at.w[u - 1]), right = Joined(w, at.w[u + 1]);
    const bool up = Joined(w, above.w[u]), down = Joined(w, below.w[u]);
    const Step l = Between(at.x[u - 1], at.y[u - 1], at.w[u - 1], x, y, w);
    const Step r = Between(x, y, w, at.x[u + 1], at.y[u + 1], at.w[u + 1]);
    const Step t = Between(above.x[u], above.y[u], above.w[u], x, y, w);
    const Step b = Between(x, y, w, below.x[u], below.y[u], below.w[u]);
    const Step hl = Half(left, l, right, r, steps.column_x, steps.column_y);
    const Step hr = Half(right, r, left, l, steps.column_x, steps.column_y);
    const Step ht = Half(up, t, down, b, steps.row_x, steps.row_y);
    const Step hb = Half(down, b, up, t, steps.row_x, steps.row_y);
    const float x_min = x + std::min(-hl.x, hr.x) + std::min(-ht.x, hb.x) - kFootprintMargin;
    const float x_max = x + std::max(-hl.x, hr.x) + std::max(-ht.x, hb.x) + kFootprintMargin;
    const float y_min = y + std::min(-hl.y, hr.y) + std::min(-ht.y, hb.y) - kFootprintMargin;
    const float y_max = y + std::max(-hl.y, hr.y) + std::max(-ht.y, hb.y) + kFootprintMargin;
    const int32_t x0 = Clamped(std::ceil(x_min), 0, width);
    const int32_t y0 = Clamped(std::ceil(y_min), 0, height);
    const int32_t x1 = Clamped(std::floor(x_max), -1, width - 1);
    const int32_t y1 = Clamped(std::floor(y_max), -1, height - 1);
    out.x0[u] = x0;
    out.y0[u] = y0;
    out.x1[u] = w > 0.0F ? std::min(x1, x0 + kMaxFootprint - 1) : -1;
    out.y1[u] = std::min(y1, y0 + kMaxFootprint - 1);
    const Step gu = Gentler(left, l, right, r, steps.column_x, steps.column_y);
    const Step gv = Gentler(up, t, down, b, steps.row_x, steps.row_y);
    const float det = gu.x * gv.y - gu.y * gv.x;
    const bool flat = std::abs(det) > 0.01F;
    const float scale = Select(flat, 1.0F, 0.0F) / Select(flat, det, 1.0F);
    out.gradient_x[u] = (gu.w * gv.y - gv.w * gu.y) * scale;
    out.gradient_y[u] = (gv.w * gu.x - gu.w * gv.x) * scale;
  }
}

}  // namespace vismap
