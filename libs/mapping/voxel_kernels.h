#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "geometry/camera.h"
#include "volume/block.h"

namespace vismap {

// The loops over all 512 voxels of a block, free of branches so that the compiler vectorises them.
// Each is compiled once per SIMD level with equal results.

template <typename T>
using VoxelArray = std::array<T, kBlockVoxels>;

/// The block's voxel centres in the camera: `first_C` = centre of voxel 0 [m], columns of `step_C`
/// = one voxel along x, y, z of W [m].
struct VoxelLattice {
  Eigen::Vector3f first_C;
  Eigen::Matrix3f step_C;
};

/// Where voxel centres fall in the image.
struct ProjectedVoxels {
  alignas(64) VoxelArray<float> z;  ///< depth [m]
  alignas(64) VoxelArray<float> u,
      v;  ///< pixel + 0.5: truncating gives the nearest pixel; any value when z <= 0
  alignas(64) VoxelArray<float> stretch;  ///< length of the ray per metre of depth
};
void ProjectVoxels(const VoxelLattice& lattice, const PinholeCamera& camera, ProjectedVoxels& out);

/// Limits of what a measurement says [m].
struct MeasurementLimits {
  float truncation, min_range, max_range, free_space_range, drop_off_start;
  bool free_space;
};

/// What a frame says of the voxels.
struct VoxelSamples {
  alignas(64) VoxelArray<float> distance;  ///< signed, along the ray, at most the truncation [m]; 0
                                           ///< where weight is 0
  alignas(64)
      VoxelArray<float> weight;  ///< in steps of 1 / kWeightScale; 0 = the frame says nothing
  alignas(64) VoxelArray<float> near,
      free;  ///< 1 = within the truncation of a surface; 1 = before it, empty
};
/// `depth` = measured depth at each voxel's pixel [m]; 0 = none.
void JudgeVoxels(const ProjectedVoxels& voxels, const VoxelArray<float>& depth,
                 const MeasurementLimits& limits, VoxelSamples& out);

/// Weighted running mean of distances and weights, and the count of observations. `shares` = how
/// much of each new mean is this frame's, [0, 1].
void FuseDistances(const VoxelSamples& samples, float truncation, float max_weight,
                   SurfaceVoxels& voxels, VoxelArray<float>& shares);

}  // namespace vismap
