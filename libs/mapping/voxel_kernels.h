#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "geometry/camera.h"
#include "map/block.h"

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
  alignas(64) VoxelArray<float> z;        ///< depth [m]
  alignas(64) VoxelArray<int32_t> pixel;  ///< offset in the image; 0 where `inside` is 0
  alignas(64) VoxelArray<float> inside;   ///< 1 = before the camera and in the image
  alignas(64) VoxelArray<float> stretch;  ///< length of the ray per metre of depth
};
void ProjectVoxels(const VoxelLattice& lattice, const PinholeCamera& camera, ProjectedVoxels& out);

/// The measured depth at each voxel's pixel [m]; 0 = none. `image` has the camera's size, NaN = no
/// return.
void LookUpDepth(const ProjectedVoxels& voxels, const float* image, VoxelArray<float>& depth);

/// Limits of what a measurement says [m].
struct MeasurementLimits {
  float truncation, min_range, max_range, free_space_range, drop_off_start;
  float vote_distance;   ///< labels are voted for this near the surface
  float color_distance;  ///< colours are kept this near the surface
  bool free_space;
};

/// What a frame says of a voxel; bits of VoxelSamples::flags.
inline constexpr uint8_t kNearSurface = 1;  ///< within the truncation of a surface
inline constexpr uint8_t kSeenFree = 2;     ///< before it, empty
inline constexpr uint8_t kTakesVote = 4;    ///< kNearSurface, and within the vote distance
inline constexpr uint8_t kTakesColor = 8;   ///< kNearSurface, and within the colour distance

/// What a frame says of the voxels.
struct VoxelSamples {
  alignas(64) VoxelArray<float> distance;  ///< signed, along the ray, at most the truncation [m]; 0
                                           ///< where weight is 0
  alignas(64)
      VoxelArray<float> weight;  ///< in steps of 1 / kWeightScale; 0 = the frame says nothing
  alignas(64) VoxelArray<uint8_t> flags;
};
/// `depth` = measured depth at each voxel's pixel [m]; 0 = none. The weights are not those yet, but
/// 1 where the frame says something.
void JudgeVoxels(const ProjectedVoxels& voxels, const VoxelArray<float>& depth,
                 const MeasurementLimits& limits, VoxelSamples& out);

/// Sets the weights of what was judged: most blocks in view have no voxels to fuse with.
void WeighVoxels(const VoxelArray<float>& depth, const MeasurementLimits& limits,
                 VoxelSamples& samples);

/// The voxels that have any of the bits of `mask` set in their flags.
VoxelBits VoxelsWith(const VoxelArray<uint8_t>& flags, uint8_t mask);
/// All bits that some voxel has set.
uint8_t UnionOf(const VoxelArray<uint8_t>& flags);

/// Caps of a voxel's weight.
struct WeightLimits {
  float most;         ///< in steps
  float free_frames;  ///< from nine tenths of the truncation on: times the frame's own weight
};

/// Weighted running mean of distances and weights, and the count of observations. `shares` = how
/// much of each new mean is this frame's, [0, 1].
void FuseDistances(const VoxelSamples& samples, float truncation, const WeightLimits& limits,
                   SurfaceVoxels& voxels, VoxelArray<float>& shares);

/// When a frame clears a voxel, and how fast.
struct CarvingLimits {
  float frames;        ///< see IntegrationOptions::carve_frames; 0 = never
  float keep;          ///< share of the weight kept
  float slope;         ///< per metre of the voxel's distance, see IntegrationOptions::carve_slope
  float max_distance;  ///< only voxels nearer to the surface, or behind it [m]
  float min_measured;  ///< no voxel is passed that is measured nearer to the surface [m]
};

/// Whether some voxel that the frame speaks of may be carved: measured farther from the surface
/// than it is, and not far before the surface in the map.
bool MayCarve(const VoxelSamples& samples, float truncation, const CarvingLimits& limits,
              const SurfaceVoxels& voxels);

/// Weakens the voxels that are clearly passed by rays: with `clear` = depth up to which space is
/// clear at each voxel's pixel [m]; 0 = none. Those with much weight lose most of it, and the frame
/// says no more of them; the others keep at most `frames` times the frame's weight. Returns the
/// voxels of the latter that are inside or on a surface.
VoxelBits CarveVoxels(const ProjectedVoxels& projected, const VoxelArray<float>& clear,
                      float truncation, const CarvingLimits& limits, VoxelSamples& samples,
                      SurfaceVoxels& voxels);

}  // namespace vismap
