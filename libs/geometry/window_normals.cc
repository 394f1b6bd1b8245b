#include "geometry/window_normals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <optional>

#include "base/parallel.h"

namespace vismap {
namespace {

/// Covariance of the points around (v, u); nullopt when there are fewer than three.
std::optional<Eigen::Matrix3f> WindowCovariance(const VectorImage& points, int v, int u,
                                                const SurfaceOptions& options) {
  const int half = options.window_px / 2;
  const Eigen::Vector3f p = points.at(v, u);
  const float reach = static_cast<float>(options.window_depth_ratio) * p.z();
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  int count = 0;
  for (int row = std::max(0, v - half); row <= std::min(points.z.height() - 1, v + half); ++row) {
    for (int col = std::max(0, u - half); col <= std::min(points.z.width() - 1, u + half); ++col) {
      const Eigen::Vector3f d = points.at(row, col) - p;  // NaN compares false below
      if (!(d.squaredNorm() < reach * reach)) continue;
      sum += d;
      squares += d * d.transpose();
      ++count;
    }
  }
  if (count < 3) return std::nullopt;
  const float n = static_cast<float>(count);
  return Eigen::Matrix3f(squares / n - sum * sum.transpose() / (n * n));
}

}  // namespace

void EstimateWindowNormals(const SurfaceOptions& options, SurfaceMap* surface) {
  const VectorImage& points = surface->points_C;
  const int width = points.z.width();
  ParallelFor(static_cast<size_t>(points.z.height()), 4, [&](size_t row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < width; ++u) {
      surface->normals_C.x(v, u) = surface->normals_C.y(v, u) = surface->normals_C.z(v, u) =
          surface->normal_sigma(v, u) = std::numeric_limits<float>::quiet_NaN();
      if (!points.valid(v, u)) continue;
      const auto covariance = WindowCovariance(points, v, u, options);
      if (!covariance) continue;
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
      solver.computeDirect(*covariance);
      Eigen::Vector3f normal = solver.eigenvectors().col(0);
      if (normal.dot(points.at(v, u)) > 0) normal = -normal;
      surface->normals_C.x(v, u) = normal.x();
      surface->normals_C.y(v, u) = normal.y();
      surface->normals_C.z(v, u) = normal.z();
      surface->normal_sigma(v, u) = 0;
    }
  });
}

}  // namespace vismap
