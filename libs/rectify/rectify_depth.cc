#include "rectify/rectify_depth.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "base/require.h"
#include "rectify/lens.h"

namespace vismap {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr int kParts = 4;  // of the depth image, each drawn into an image of its own

// The projections of one row, with a pixel without depth on both sides.
class RowOfPoints {
 public:
  explicit RowOfPoints(int width) : values_(3 * (static_cast<size_t>(width) + 2)) {}
  ProjectedRow row() {
    const size_t stride = values_.size() / 3;
    return {&values_[1], &values_[stride + 1], &values_[2 * stride + 1]};
  }
  void Clear() { std::fill(values_.begin(), values_.end(), 0.0F); }

 private:
  std::vector<float> values_;
};

class Footprints {
 public:
  explicit Footprints(int width)
      : stride_(static_cast<size_t>(width)), bounds_(4 * stride_), gradients_(2 * stride_) {}
  FootprintRow row() {
    return {&bounds_[0],           &bounds_[stride_], &bounds_[2 * stride_],
            &bounds_[3 * stride_], &gradients_[0],    &gradients_[stride_]};
  }

 private:
  size_t stride_;
  std::vector<int32_t> bounds_;
  std::vector<float> gradients_;
};

void ProjectInto(const Image<float>& depth_m, const DepthTable& table, int v, RowOfPoints* points) {
  if (v < 0 || v >= depth_m.height()) return points->Clear();
  const RayRow rays{table.rx.row(v), table.ry.row(v), table.rz.row(v),
                    table.tx,        table.ty,        table.tz};
  ProjectRow(depth_m.row(v), rays, depth_m.width(), points->row());
}

// Draws one row; `nearest` has the inverse depth of what is in front so far, 0 = nothing.
void DrawRow(const ProjectedRow& at, const FootprintRow& footprints, int count,
             Image<float>* nearest) {
  for (int u = 0; u < count; ++u) {
    const float w = at.w[u], gx = footprints.gradient_x[u], gy = footprints.gradient_y[u];
    const float low = w * (1 - kMaxJoinedStep), high = w * (1 + kMaxJoinedStep);
    for (int y = footprints.y0[u]; y <= footprints.y1[u]; ++y) {
      float* row = nearest->row(y);
      const float in_row = (static_cast<float>(y) - at.y[u]) * gy;
      for (int x = footprints.x0[u]; x <= footprints.x1[u]; ++x) {
        const float there = w + (static_cast<float>(x) - at.x[u]) * gx + in_row;
        row[x] = std::max(row[x], std::min(std::max(there, low), high));
      }
    }
  }
}

void DrawRows(const Image<float>& depth_m, const DepthTable& table, int from, int to,
              Image<float>* nearest) {
  const int width = depth_m.width();
  std::array<RowOfPoints, 3> rows{RowOfPoints(width), RowOfPoints(width), RowOfPoints(width)};
  Footprints footprints(width);
  ProjectInto(depth_m, table, from - 1, &rows[0]);
  ProjectInto(depth_m, table, from, &rows[1]);
  for (int v = from; v < to; ++v) {
    ProjectInto(depth_m, table, v + 1, &rows[2]);
    MeasureRow(rows[0].row(), rows[1].row(), rows[2].row(), table.steps, table.target.width,
               table.target.height, width, footprints.row());
    DrawRow(rows[1].row(), footprints.row(), width, nearest);
    std::rotate(rows.begin(), rows.begin() + 1, rows.end());
  }
}

// Where neighbours of the same depth appear, at the middle of the image and without distortion.
PixelSteps StepsOf(const LensCamera& from, const Eigen::Matrix3d& R, const PinholeCamera& to) {
  const double kx = to.fx / from.pinhole.fx, ky = to.fy / from.pinhole.fy;
  const double kxy = to.fx / from.pinhole.fy, kyx = to.fy / from.pinhole.fx;
  return {static_cast<float>(kx * R(0, 0)), static_cast<float>(kyx * R(1, 0)),
          static_cast<float>(kxy * R(0, 1)), static_cast<float>(ky * R(1, 1))};
}

}  // namespace

DepthTable MakeDepthTable(const LensCamera& from, const Pose& T_target_from,
                          const PinholeCamera& target) {
  const int width = from.pinhole.width, height = from.pinhole.height;
  DepthTable table;
  table.target = target;
  table.rx = table.ry = table.rz = Image<float>(width, height, kNaN);
  Eigen::Matrix3d K;
  K << target.fx, 0, target.cx, 0, target.fy, target.cy, 0, 0, 1;
  const Eigen::Matrix3d KR = K * T_target_from.linear();
  const Eigen::Vector3f Kt = (K * T_target_from.translation()).cast<float>();
  table.tx = Kt.x();
  table.ty = Kt.y();
  table.tz = Kt.z();
  table.steps = StepsOf(from, T_target_from.linear(), target);
  const double limit = MaxRayRadius(from);
  ParallelFor(static_cast<size_t>(height), 8, [&](size_t row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < width; ++u) {
      const auto ray = Undistort(from, Eigen::Vector2d(u, v));
      if (!ray || ray->norm() > limit) continue;
      const Eigen::Vector3f r = (KR * Eigen::Vector3d(ray->x(), ray->y(), 1)).cast<float>();
      table.rx(v, u) = r.x();
      table.ry(v, u) = r.y();
      table.rz(v, u) = r.z();
    }
  });
  return table;
}

Image<float> RectifyDepth(const Image<float>& depth_m, const DepthTable& table) {
  Require(depth_m.width() == table.rx.width() && depth_m.height() == table.rx.height(),
          "depth has the size of its table");
  const PinholeCamera& target = table.target;
  const auto height = static_cast<size_t>(depth_m.height());
  std::array<Image<float>, kParts> parts;
  ParallelFor(kParts, 1, [&](size_t i) {
    parts[i] = Image<float>(target.width, target.height, 0.0F);
    DrawRows(depth_m, table, static_cast<int>(height * i / kParts),
             static_cast<int>(height * (i + 1) / kParts), &parts[i]);
  });
  // The order of the parts does not matter, since the largest inverse depth wins.
  Image<float> result = Image<float>::Unset(target.width, target.height);
  ParallelFor(static_cast<size_t>(target.height), 32, [&](size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < target.width; ++x) {
      float w = 0;
      for (const Image<float>& part : parts) w = std::max(w, part(y, x));
      result(y, x) = w > 0 ? 1 / w : kNaN;
    }
  });
  return result;
}

}  // namespace vismap
