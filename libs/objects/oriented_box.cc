#include "objects/oriented_box.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace vismap {
namespace {

struct Interval {
  double low = 0, high = 0;
  double length() const { return high - low; }
};

// The range of the values without the share `outliers` of them, half of it at each end.
Interval TrimmedRange(std::vector<double>* values, double outliers) {
  const size_t n = values->size();
  const auto cut =
      std::min(static_cast<size_t>(outliers / 2 * static_cast<double>(n)), (n - 1) / 2);
  const auto low = values->begin() + static_cast<std::ptrdiff_t>(cut);
  const auto high = values->begin() + static_cast<std::ptrdiff_t>(n - 1 - cut);
  std::nth_element(values->begin(), low, values->end());
  const double lowest = *low;
  std::nth_element(low, high, values->end());
  return {lowest, *high};
}

Interval RangeAlong(std::span<const Eigen::Vector3f> points, const Eigen::Vector3d& axis,
                    double outliers) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector3f& p : points) values.push_back(p.cast<double>().dot(axis));
  return TrimmedRange(&values, outliers);
}

struct Base {
  Eigen::Vector3d x, y;  // horizontal axes of the box
};

Base Turned(const Eigen::Vector3d& u, const Eigen::Vector3d& v, double yaw) {
  return {u * std::cos(yaw) + v * std::sin(yaw), v * std::cos(yaw) - u * std::sin(yaw)};
}

// The yaw [rad] with the smallest base area, searched in steps of 3, then 0.5, then 0.1 degrees.
double BestYaw(std::span<const Eigen::Vector3f> points, const Eigen::Vector3d& u,
               const Eigen::Vector3d& v, double outliers) {
  constexpr double kDegree = std::numbers::pi / 180;
  const auto area = [&](double yaw) {
    const Base base = Turned(u, v, yaw);
    return RangeAlong(points, base.x, outliers).length() *
           RangeAlong(points, base.y, outliers).length();
  };
  double best = 0, smallest = area(0);
  const auto search = [&](double center, double step, int steps_down, int steps_up) {
    for (int i = -steps_down; i <= steps_up; ++i) {
      const double yaw = center + i * step;
      const double found = area(yaw);
      if (found < smallest) best = yaw;
      smallest = std::min(smallest, found);
    }
  };
  search(0, 3 * kDegree, 0, 29);
  search(best, 0.5 * kDegree, 5, 5);
  search(best, 0.1 * kDegree, 4, 4);
  return best;
}

// At most `limit` of the points, evenly chosen.
std::vector<Eigen::Vector3f> Thinned(std::span<const Eigen::Vector3f> points, size_t limit) {
  const size_t stride = (points.size() + limit - 1) / limit;
  std::vector<Eigen::Vector3f> picked;
  for (size_t i = 0; i < points.size(); i += stride) picked.push_back(points[i]);
  return picked;
}

using Cell = std::array<int32_t, 3>;

Cell CellOf(const Eigen::Vector3f& p, double size) {
  const Eigen::Vector3d c = (p.cast<double>() / size).array().floor();
  return {static_cast<int32_t>(c.x()), static_cast<int32_t>(c.y()), static_cast<int32_t>(c.z())};
}

size_t Root(std::vector<size_t>& parent, size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Finds the connected groups of cells that touch, also at edges and corners. Returns for each cell
// the index of the first cell of its group. `cells` are sorted.
std::vector<size_t> ConnectCells(const std::vector<Cell>& cells) {
  std::vector<size_t> parent(cells.size());
  std::iota(parent.begin(), parent.end(), size_t{0});
  for (size_t i = 0; i < cells.size(); ++i) {
    for (int n = 0; n < 27; ++n) {
      const Cell near{cells[i][0] + n % 3 - 1, cells[i][1] + n / 3 % 3 - 1,
                      cells[i][2] + n / 9 - 1};
      if (!(near < cells[i])) continue;
      const auto found = std::lower_bound(cells.begin(), cells.end(), near);
      if (found == cells.end() || *found != near) continue;
      const size_t a = Root(parent, i);
      const size_t b = Root(parent, static_cast<size_t>(found - cells.begin()));
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  for (size_t i = 0; i < parent.size(); ++i) parent[i] = Root(parent, i);
  return parent;
}

PlaneFit LeastSquaresPlane(std::span<const Eigen::Vector3f> points) {
  PlaneFit fit;
  for (const Eigen::Vector3f& p : points) fit.point_W += p.cast<double>();
  fit.point_W /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d d = p.cast<double>() - fit.point_W;
    scatter += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  fit.normal_W = solver.eigenvectors().col(0);
  fit.roughness =
      std::sqrt(std::max(solver.eigenvalues()[0], 0.0) / static_cast<double>(points.size()));
  return fit;
}

std::vector<Eigen::Vector3f> Near(const PlaneFit& plane, std::span<const Eigen::Vector3f> points,
                                  double distance) {
  std::vector<Eigen::Vector3f> near;
  for (const Eigen::Vector3f& p : points) {
    const double off = (p.cast<double>() - plane.point_W).dot(plane.normal_W);
    if (std::abs(off) <= distance) near.push_back(p);
  }
  return near;
}

}  // namespace

std::pair<Eigen::Vector3d, Eigen::Vector3d> HorizontalAxes(const Eigen::Vector3d& up_W) {
  const Eigen::Vector3d start =
      std::abs(up_W.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d u = (start - up_W * up_W.dot(start)).normalized();
  return {u, up_W.cross(u)};
}

OrientedBox FitUprightBox(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3d& up_W,
                          double outliers) {
  if (points_W.empty()) return {};
  const auto [u, v] = HorizontalAxes(up_W);
  // A sample of the points is enough to find the yaw, but not to find the extents.
  double yaw = BestYaw(Thinned(points_W, 1500), u, v, outliers);
  Base base = Turned(u, v, yaw);
  if (RangeAlong(points_W, base.x, outliers).length() <
      RangeAlong(points_W, base.y, outliers).length()) {
    yaw -= std::numbers::pi / 2;
    base = Turned(u, v, yaw);
  }
  OrientedBox box;
  const std::array<Eigen::Vector3d, 3> axes{base.x, base.y, up_W};
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d& axis = axes[static_cast<size_t>(i)];
    const Interval range = RangeAlong(points_W, axis, outliers);
    box.size[i] = range.length();
    box.center_W += axis * (range.low + range.high) / 2;
    rotation.col(i) = axis;
  }
  box.R_W_B = Eigen::Quaterniond(rotation).normalized();
  return box;
}

std::vector<Eigen::Vector3f> MainParts(std::span<const Eigen::Vector3f> points_W, double gap,
                                       double min_share) {
  if (!(gap > 0)) return {points_W.begin(), points_W.end()};
  std::vector<Cell> cells;
  for (const Eigen::Vector3f& p : points_W) cells.push_back(CellOf(p, gap));
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const std::vector<size_t> part_of_cell = ConnectCells(cells);

  std::vector<size_t> part(points_W.size());
  std::vector<size_t> sizes(cells.size(), 0);
  for (size_t i = 0; i < points_W.size(); ++i) {
    const auto cell = std::lower_bound(cells.begin(), cells.end(), CellOf(points_W[i], gap));
    part[i] = part_of_cell[static_cast<size_t>(cell - cells.begin())];
    ++sizes[part[i]];
  }
  const size_t largest = sizes.empty() ? 0 : *std::max_element(sizes.begin(), sizes.end());
  const double enough =
      std::min(static_cast<double>(largest), min_share * static_cast<double>(points_W.size()));
  std::vector<Eigen::Vector3f> kept;
  for (size_t i = 0; i < points_W.size(); ++i) {
    if (static_cast<double>(sizes[part[i]]) >= enough) kept.push_back(points_W[i]);
  }
  return kept;
}

PlaneFit FitPlane(std::span<const Eigen::Vector3f> points_W, double flatness) {
  if (points_W.size() < 3) return {};
  PlaneFit fit = LeastSquaresPlane(points_W);
  for (int round = 0; round < 2; ++round) {
    const std::vector<Eigen::Vector3f> near = Near(fit, points_W, 2 * flatness);
    if (near.size() < 3) return fit;
    fit = LeastSquaresPlane(near);
  }
  fit.inliers = static_cast<double>(Near(fit, points_W, flatness).size()) /
                static_cast<double>(points_W.size());
  return fit;
}

}  // namespace vismap
