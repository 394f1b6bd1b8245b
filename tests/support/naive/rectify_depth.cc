#include "support/naive/rectify_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace vismap::naive {
namespace {

/// Where a pixel of depth appears in the rectified image, and its inverse depth.
struct Point {
  float x, y, w;
};

/// A displacement in the rectified image, and the change of inverse depth over it.
struct Step {
  float x, y, w;
};

std::optional<Point> Project(const Image<float>& depth_m, const DepthTable& table, int v, int u) {
  if (!depth_m.Contains(v, u)) return std::nullopt;
  const float z = depth_m(v, u);
  if (!(z > 0 && z < kFarthestDepth)) return std::nullopt;
  const float depth = z * table.rz(v, u) + table.tz;
  if (!(depth > kNearestDepth)) return std::nullopt;
  const float w = 1 / depth;
  return Point{(z * table.rx(v, u) + table.tx) * w, (z * table.ry(v, u) + table.ty) * w, w};
}

/// The step from one point to its neighbour, if both lie on one surface.
std::optional<Step> StepBetween(const std::optional<Point>& a, const std::optional<Point>& b) {
  if (!a || !b || std::abs(a->w - b->w) > kMaxJoinedStep * std::min(a->w, b->w))
    return std::nullopt;
  return Step{b->x - a->x, b->y - a->y, b->w - a->w};
}

/// How far a pixel reaches towards a neighbour: half a step.
Step Reach(const std::optional<Step>& step, const std::optional<Step>& other, Step nominal) {
  const Step s = step ? *step : other ? *other : nominal;
  return {0.5F * s.x, 0.5F * s.y, 0};
}

/// The step with the smaller slope; no slope at a ridge, and beside depth jumps on both sides.
Step Slope(const std::optional<Step>& before, const std::optional<Step>& after, Step nominal) {
  if (!before && !after) return nominal;
  if (!before) return *after;
  if (!after) return *before;
  Step gentler = std::abs(after->w) < std::abs(before->w) ? *after : *before;
  if (before->w * after->w <= 0) gentler.w = 0;
  return gentler;
}

}  // namespace

Image<float> RectifyDepth(const Image<float>& depth_m, const DepthTable& table) {
  const PinholeCamera& target = table.target;
  Image<float> nearest(target.width, target.height, 0);  // inverse depth
  const Step column{table.steps.column_x, table.steps.column_y, 0};
  const Step row{table.steps.row_x, table.steps.row_y, 0};
  for (int v = 0; v < depth_m.height(); ++v) {
    for (int u = 0; u < depth_m.width(); ++u) {
      const auto at = [&](int dv, int du) { return Project(depth_m, table, v + dv, u + du); };
      const std::optional<Point> p = at(0, 0);
      if (!p) continue;
      const auto left = StepBetween(at(0, -1), p), right = StepBetween(p, at(0, 1));
      const auto up = StepBetween(at(-1, 0), p), down = StepBetween(p, at(1, 0));
      const Step l = Reach(left, right, column), r = Reach(right, left, column);
      const Step t = Reach(up, down, row), b = Reach(down, up, row);
      const float x_min = p->x + std::min(-l.x, r.x) + std::min(-t.x, b.x) - kFootprintMargin;
      const float x_max = p->x + std::max(-l.x, r.x) + std::max(-t.x, b.x) + kFootprintMargin;
      const float y_min = p->y + std::min(-l.y, r.y) + std::min(-t.y, b.y) - kFootprintMargin;
      const float y_max = p->y + std::max(-l.y, r.y) + std::max(-t.y, b.y) + kFootprintMargin;

      // Along a column step and along a row step, inverse depth changes by the steps' w.
      const Step c = Slope(left, right, column), d = Slope(up, down, row);
      const float det = c.x * d.y - c.y * d.x;
      const bool flat = std::abs(det) > 0.01F;
      const float scale = flat ? 1 / det : 0;
      const float gradient_x = (c.w * d.y - d.w * c.y) * scale;
      const float gradient_y = (d.w * c.x - c.w * d.x) * scale;

      const float first_x = std::max(std::ceil(x_min), 0.0F);
      const float first_y = std::max(std::ceil(y_min), 0.0F);
      for (float y = first_y; y <= y_max && y < first_y + kMaxFootprint; ++y) {
        for (float x = first_x; x <= x_max && x < first_x + kMaxFootprint; ++x) {
          if (x >= float(target.width) || y >= float(target.height)) continue;
          const float w = p->w + (x - p->x) * gradient_x + (y - p->y) * gradient_y;
          const float low = p->w * (1 - kMaxJoinedStep), high = p->w * (1 + kMaxJoinedStep);
          float& there = nearest(static_cast<int>(y), static_cast<int>(x));
          there = std::max(there, std::min(std::max(w, low), high));
        }
      }
    }
  }
  Image<float> result(target.width, target.height, std::numeric_limits<float>::quiet_NaN());
  for (size_t i = 0; i < result.size(); ++i) {
    if (nearest.data()[i] > 0) result.data()[i] = 1 / nearest.data()[i];
  }
  return result;
}

}  // namespace vismap::naive
