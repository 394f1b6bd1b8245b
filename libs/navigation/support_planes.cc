#include "navigation/support_planes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace vismap {
namespace {

constexpr size_t kMostSamples = 1500, kFewestInPlane = 40;  // of one thing
constexpr int kTrials = 60, kMostPlanes = 2;
constexpr float kFlat = 1.25F;  // samples of a plane are within this distance of it [voxels]

using Samples = std::vector<SurfaceSample>;

/// The surface point that a voxel stands for, in a plane with this normal.
Eigen::Vector3f FootOf(const SurfaceSample& sample, const Eigen::Vector3f& normal) {
  return sample.at - sample.distance * normal;
}

size_t CountNear(const Samples& samples, const SupportPlane& plane) {
  return static_cast<size_t>(std::count_if(samples.begin(), samples.end(), [&](const auto& s) {
    return std::abs(plane.HeightOf(s.at)) <= kFlat;
  }));
}

/// A random number that is the same in every run.
class Chance {
 public:
  size_t Below(size_t count) {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<size_t>(state_ >> 33) % count;
  }

 private:
  uint64_t state_ = 1;
};

/// The best of some planes through three samples; nullopt when all of them lie on a line.
std::optional<SupportPlane> BestOfTrials(const Samples& samples) {
  std::optional<SupportPlane> best;
  size_t most = 0;
  Chance chance;
  for (int i = 0; i < kTrials; ++i) {
    const Eigen::Vector3f& a = samples[chance.Below(samples.size())].at;
    const Eigen::Vector3f& b = samples[chance.Below(samples.size())].at;
    const Eigen::Vector3f& c = samples[chance.Below(samples.size())].at;
    const Eigen::Vector3f across = (b - a).cross(c - a);
    if (across.norm() < 8) continue;  // too near to each other for a direction
    SupportPlane plane;
    plane.point = a;
    plane.normal = across.normalized();
    const size_t count = CountNear(samples, plane);
    if (count <= most) continue;
    most = count;
    best = plane;
  }
  return best;
}

/// Fits the plane to the samples near it: its normal is the direction of their least spread, toward
/// growing distances.
void Refine(const Samples& samples, SupportPlane* plane) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  double count = 0;
  for (const SurfaceSample& sample : samples) {
    if (std::abs(plane->HeightOf(sample.at)) > kFlat) continue;
    const Eigen::Vector3d at = (sample.at - plane->point).cast<double>();
    sum += at;
    products += at * at.transpose();
    ++count;
  }
  const Eigen::Vector3d mean = sum / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(products / count -
                                                            mean * mean.transpose());
  plane->normal = axes.eigenvectors().col(0).cast<float>();
  plane->along[0] = axes.eigenvectors().col(2).cast<float>();
  plane->along[1] = axes.eigenvectors().col(1).cast<float>();
  plane->point += mean.cast<float>();
  double rising = 0, offset = 0, used = 0;
  for (const SurfaceSample& sample : samples) {
    if (std::abs(plane->HeightOf(sample.at)) <= kFlat)
      rising += double{sample.distance} * plane->HeightOf(sample.at);
  }
  if (rising < 0) plane->normal = -plane->normal;
  for (const SurfaceSample& sample : samples) {
    if (std::abs(plane->HeightOf(sample.at)) > kFlat) continue;
    offset += plane->HeightOf(FootOf(sample, plane->normal));
    ++used;
  }
  if (used > 0) plane->point += static_cast<float>(offset / used) * plane->normal;
}

void SetExtent(const Samples& samples, SupportPlane* plane) {
  plane->low.setConstant(INFINITY);
  plane->high.setConstant(-INFINITY);
  for (const SurfaceSample& sample : samples) {
    if (std::abs(plane->HeightOf(sample.at)) > kFlat) continue;
    const Eigen::Vector3f from = sample.at - plane->point;
    const Eigen::Vector2f at(plane->along[0].dot(from), plane->along[1].dot(from));
    plane->low = plane->low.cwiseMin(at);
    plane->high = plane->high.cwiseMax(at);
  }
}

/// Adds the planes of one thing.
void AddPlanes(Samples samples, std::vector<SupportPlane>* planes) {
  const size_t least = std::max(kFewestInPlane, samples.size() / 3);
  for (int i = 0; i < kMostPlanes && samples.size() >= least; ++i) {
    std::optional<SupportPlane> plane = BestOfTrials(samples);
    if (!plane || CountNear(samples, *plane) < least) return;
    Refine(samples, &*plane);
    Refine(samples, &*plane);
    if (CountNear(samples, *plane) < least) return;
    SetExtent(samples, &*plane);
    plane->surface = samples.front().surface;
    planes->push_back(*plane);
    std::erase_if(samples, [&](const SurfaceSample& sample) {
      return std::abs(plane->HeightOf(sample.at)) <= 2 * kFlat;
    });
  }
}

}  // namespace

bool SupportPlane::Covers(const Eigen::Vector3f& at) const {
  const Eigen::Vector3f from = at - point;
  const Eigen::Vector2f place(along[0].dot(from), along[1].dot(from));
  return (place.array() >= low.array()).all() && (place.array() <= high.array()).all();
}

std::vector<SupportPlane> FindSupportPlanes(std::span<const SurfaceSample> samples) {
  std::map<uint8_t, size_t> counts;
  for (const SurfaceSample& sample : samples) ++counts[sample.surface];
  std::vector<SupportPlane> planes;
  for (const auto& [surface, count] : counts) {
    if (count < kFewestInPlane) continue;
    const size_t step = (count + kMostSamples - 1) / kMostSamples;
    Samples own;
    size_t next = 0;
    for (const SurfaceSample& sample : samples) {
      if (sample.surface == surface && next++ % step == 0) own.push_back(sample);
    }
    AddPlanes(std::move(own), &planes);
  }
  return planes;
}

}  // namespace vismap
