#include "evaluation/surface_error.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "evaluation/nearest.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

constexpr size_t kSamples = 50000;   // at least so many vertices are sampled, if there are so many
constexpr size_t kCandidates = 12;   // triangles that are checked per point
constexpr double kLargestGap = 0.2;  // largest distance in the mean completeness [m]
constexpr double kTiny = 1e-18;      // avoids division by zero for triangles without area

double DistanceToEdge(const Vector3d& p, const Vector3d& from, const Vector3d& edge) {
  const Vector3d q = p - from;
  const double t = std::clamp(q.dot(edge) / std::max(edge.squaredNorm(), kTiny), 0.0, 1.0);
  return (q - t * edge).norm();
}

double DistanceToTriangle(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                          const Vector3d& c) {
  const Vector3d e0 = b - a, e1 = c - a, w = p - a;
  const double d00 = e0.dot(e0), d01 = e0.dot(e1), d11 = e1.dot(e1);
  const double d20 = w.dot(e0), d21 = w.dot(e1);
  double area = d00 * d11 - d01 * d01;
  if (std::abs(area) < kTiny) area = kTiny;
  const double s = (d11 * d20 - d01 * d21) / area, t = (d00 * d21 - d01 * d20) / area;
  double distance = std::numeric_limits<double>::infinity();
  if (s >= 0 && t >= 0 && s + t <= 1) distance = (w - s * e0 - t * e1).norm();
  return std::min(
      {distance, DistanceToEdge(p, a, e0), DistanceToEdge(p, a, e1), DistanceToEdge(p, b, c - b)});
}

// Computes distances to the surface of a ground truth.
class TruthSurface {
 public:
  explicit TruthSurface(const GroundTruth& truth) : truth_(truth), tree_(Sites(truth)) {}

  double Distance(const Vector3d& p) const {
    if (truth_.triangles.empty()) return tree_.Nearest(p)->distance;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Neighbour& neighbour : tree_.Nearest(p, kCandidates)) {
      const auto& corners = truth_.triangles[neighbour.index];
      nearest = std::min(
          nearest, DistanceToTriangle(p, Point(corners[0]), Point(corners[1]), Point(corners[2])));
    }
    return nearest;
  }

 private:
  // Centroids of the triangles, or the points of a cloud.
  static std::vector<Vector3d> Sites(const GroundTruth& truth) {
    std::vector<Vector3d> sites;
    const auto point = [&](uint32_t i) { return Vector3d(truth.points_W[i].cast<double>()); };
    for (const auto& [a, b, c] : truth.triangles)
      sites.push_back((point(a) + point(b) + point(c)) / 3);
    for (size_t i = 0; truth.triangles.empty() && i < truth.points_W.size(); ++i)
      sites.push_back(truth.points_W[i].cast<double>());
    return sites;
  }
  Vector3d Point(uint32_t i) const { return truth_.points_W[i].cast<double>(); }

  const GroundTruth& truth_;
  NearestPoints tree_;
};

// Every n-th finite vertex: between kSamples and 2 * kSamples of them, or all if there are fewer.
std::vector<Vector3d> SampleVertices(const Mesh& mesh) {
  std::vector<Vector3d> finite, samples;
  for (const MeshVertex& vertex : mesh.vertices) {
    if (vertex.position_W.allFinite()) finite.push_back(vertex.position_W.cast<double>());
  }
  const size_t step = std::max<size_t>(1, finite.size() / kSamples);
  for (size_t i = 0; i < finite.size(); i += step) samples.push_back(finite[i]);
  return samples;
}

double Percentile(const std::vector<double>& ascending, double share) {
  const double at = share * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<size_t>(at);
  if (below + 1 >= ascending.size()) return ascending.back();
  const double part = at - std::floor(at);
  if (part == 0) return ascending[below];  // the next one may be infinite
  return ascending[below] + part * (ascending[below + 1] - ascending[below]);
}

}  // namespace

std::optional<DistanceSummary> SummarizeDistances(std::vector<double> distances, double radius,
                                                  double cap) {
  if (distances.empty()) return std::nullopt;
  DistanceSummary summary;
  summary.samples = distances.size();
  size_t within = 0;
  for (const double distance : distances) {
    summary.mean += cap > 0 ? std::min(distance, cap) : distance;
    within += distance < radius;
  }
  summary.mean /= static_cast<double>(distances.size());
  summary.within_radius = static_cast<double>(within) / static_cast<double>(distances.size());
  std::sort(distances.begin(), distances.end());
  summary.median = Percentile(distances, 0.5);
  summary.p95 = Percentile(distances, 0.95);
  return summary;
}

SurfaceError ScoreSurface(const GroundTruth& truth, const Mesh& mesh,
                          const TransferredLabels& labels, double radius) {
  SurfaceError error;
  error.completeness = SummarizeDistances(labels.distance, radius, kLargestGap);
  if (truth.points_W.empty()) return error;
  const TruthSurface surface(truth);
  const std::vector<Vector3d> samples = SampleVertices(mesh);
  std::vector<double> distances(samples.size());
  ParallelFor(samples.size(), 64, [&](size_t i) { distances[i] = surface.Distance(samples[i]); });
  error.accuracy = SummarizeDistances(std::move(distances), radius);
  return error;
}

}  // namespace vismap
