#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace vismap {

/// A point on the surface of a thing beside an object. Lengths are in voxels.
struct SurfaceSample {
  Eigen::Vector3f at;   ///< centre of a voxel near the surface
  float distance = 0;   ///< signed distance of this voxel to the surface
  uint8_t surface = 0;  ///< which thing: samples of one thing have the same number
};

/// A plane that an object stands on or leans against, as far as it was seen around the object.
/// Lengths are in voxels.
struct SupportPlane {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< unit length, toward free space
  Eigen::Vector3f along[2] = {Eigen::Vector3f::UnitX(), Eigen::Vector3f::UnitY()};  ///< in it
  Eigen::Vector2f low = Eigen::Vector2f::Zero();   ///< extent of its samples from `point`, ...
  Eigen::Vector2f high = Eigen::Vector2f::Zero();  ///< ... along these two
  uint8_t surface = 0;                             ///< of the samples

  float HeightOf(const Eigen::Vector3f& at) const { return normal.dot(at - point); }
  /// Whether the foot of the perpendicular from `at` lies within the extent.
  bool Covers(const Eigen::Vector3f& at) const;
};

/// The planes that most samples of a thing lie in; at most two for each thing, each with a third of
/// its samples and at least 40. The same samples give the same planes.
std::vector<SupportPlane> FindSupportPlanes(std::span<const SurfaceSample> samples);

}  // namespace vismap
