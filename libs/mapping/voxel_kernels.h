#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "geometry/camera.h"
#include "map/block.h"

namespace vismap {

// The loops of IntegrateFrame over all 512 voxels of a block. They have no branches, so that the
// compiler vectorises them, and are compiled once per SIMD level with equal results.
//
// Symbols; as in Curless and Levoy 1996, small letters are of one frame and capitals are what a
// voxel accumulates:
// - p_C: centre of the voxel in the camera frame; z = its third coordinate [m]
// - z_m: measured depth at the voxel's pixel [m]
// - d: signed distance along the ray from the voxel to the measured surface; positive in front [m]
// - w: weight of the frame for the voxel [1 / S]
// - D: mean distance [τ / N]
// - W: weight [1 / S]
// - n: number of observations
// - τ: truncation distance [m]; N = kTruncationSteps; S = kWeightScale
//
// Every kernel names its twin: plain code for one voxel in tests/support/naive/integrate.cc. The
// tests IntegrateFrame.EqualsTheNaiveOne* in tests/mapping/naive_integrate_test.cc (random frames)
// and Pipeline.MapHasTheHashOfTheNaiveOne in tests/oracle/pipeline_oracle_test.cc (whole maps) hold
// the two equal, bit for bit.

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
/// For voxel (i, j, k): p_C = first_C + step_C (i, j, k)^T; u = fx p_x / z + cx and
/// v = fy p_y / z + cy, both rounded to the nearest pixel; stretch = |p_C| / z. Inside when z > 0
/// and (u, v) is a pixel of the image. Twin: View::Look.
void ProjectVoxels(const VoxelLattice& lattice, const PinholeCamera& camera, ProjectedVoxels& out);

/// z_m = image(v, u), or 0 without a return or outside the image. `image` has the camera's size,
/// NaN = no return. Twin: View::Look.
void LookUpDepth(const ProjectedVoxels& voxels, const float* image, VoxelArray<float>& depth);

/// The ranges within which a measurement counts, and for what [m].
struct MeasurementLimits {
  float truncation = 0;        ///< distances beyond it are free space in front, hidden behind
  float min_range = 0;         ///< nearer depth does not count, nor do nearer voxels
  float max_range = 0;         ///< farther depth leaves no surface
  float free_space_range = 0;  ///< voxels beyond it do not become free space
  float drop_off_start = 0;  ///< signed distance from which the weight fades out to the truncation
  float vote_distance = 0;   ///< labels are voted for up to this distance from the surface
  float color_distance = 0;  ///< colours are kept up to this distance from the surface
  bool free_space = false;   ///< whether free space is recorded at all
};

/// What a frame shows of a voxel; bits of VoxelSamples::flags.
inline constexpr uint8_t kNearSurface = 1;  ///< -τ <= d < τ
inline constexpr uint8_t kSeenFree = 2;     ///< d >= τ: the ray passed through the voxel
inline constexpr uint8_t kTakesVote = 4;    ///< kNearSurface, and |d| <= the vote distance
inline constexpr uint8_t kTakesColor = 8;   ///< kNearSurface, and |d| <= the colour distance

/// What a frame shows of the voxels.
struct VoxelSamples {
  alignas(64) VoxelArray<float> distance;  ///< min(d, τ) [m]; 0 where the weight is 0
  alignas(64) VoxelArray<float> weight;    ///< w [1 / S]; 0 = the frame does not show the voxel
  alignas(64) VoxelArray<uint8_t> flags;
};
/// d = (z_m - z) stretch, and what follows from it. The frame shows a voxel when z_m and z are at
/// least min_range, and either it is near a surface and z_m <= max_range, or it is seen free, z <=
/// free_space_range and free space is recorded. The weights are set to 1 or 0 here; WeighVoxels
/// computes their values. Twin: View::Judge.
void JudgeVoxels(const ProjectedVoxels& voxels, const VoxelArray<float>& depth,
                 const MeasurementLimits& limits, VoxelSamples& out);

/// w = max(1, S min(1, (τ + d) / (τ + drop_off_start)) / max(z_m, 0.5)^2), z_m in metres, where the
/// weight is not 0: the variance of depth grows with its square, and the weight fades out behind
/// the surface. A step of its own, since most blocks in view need no weights. Twin: View::Weight.
void WeighVoxels(const VoxelArray<float>& depth, const MeasurementLimits& limits,
                 VoxelSamples& samples);

/// The voxels that have any of the bits of `mask` set in their flags. Twin: the `if (sample->...)`
/// of FuseBlock.
VoxelBits VoxelsWith(const VoxelArray<uint8_t>& flags, uint8_t mask);
/// All bits that some voxel has set. Twin: Count.
uint8_t UnionOf(const VoxelArray<uint8_t>& flags);

/// Upper limits of a voxel's weight.
struct WeightLimits {
  float most = 0;         ///< [1 / S]
  float free_frames = 0;  ///< where D >= 0.9 N: this many times the frame's own weight
};

/// The running mean of the distance, per voxel:
///   share = w / max(W + w, 1),  D <- D + share (d N / τ - D),
///   W <- min(W + w, most), and at most free_frames w where w > 0 and the new D >= 0.9 N,
///   n <- min(n + 1, 255) where w > 0.
/// `shares` = share, [0, 1]. Twin: FuseVoxel.
void FuseDistances(const VoxelSamples& samples, float truncation, const WeightLimits& limits,
                   SurfaceVoxels& voxels, VoxelArray<float>& shares);

/// When rays that pass a voxel reduce its weight, and by how much.
struct CarvingLimits {
  float frames = 0;        ///< IntegrationOptions::carve_frames; 0 = never
  float keep = 0;          ///< share of the weight that is kept
  float slope = 0;         ///< IntegrationOptions::carve_slope
  float max_distance = 0;  ///< voxels farther in front of the mapped surface stay as they are [m]
  float min_measured = 0;  ///< voxels with a smaller d are not passed [m]
};

/// Whether some voxel has W > 0, w > 0, d >= min_measured and D τ / N < max_distance: CarveVoxels
/// changes no others, so that most blocks skip it. Twin: none; CarveVoxel runs on every voxel.
bool MayCarve(const VoxelSamples& samples, float truncation, const CarvingLimits& limits,
              const SurfaceVoxels& voxels);

/// Reduces the weight of voxels that rays clearly passed. With `clear` = depth up to which space is
/// clear at the voxel's pixel [m], 0 = unknown, a voxel with W > 0 and w > 0 is passed when
///   clear - z > slope max(D τ / N, 0)  and  D τ / N < max_distance.
/// When W > (frames + 2) w: W <- max(keep W, frames w), and the frame does not change the voxel any
/// more (w <- 0). Otherwise W <- min(W, frames w). Returns the passed voxels of the second kind
/// with D <= 0: this frame may turn them from solid to free. Twin: CarveVoxel.
VoxelBits CarveVoxels(const ProjectedVoxels& projected, const VoxelArray<float>& clear,
                      float truncation, const CarvingLimits& limits, VoxelSamples& samples,
                      SurfaceVoxels& voxels);

}  // namespace vismap
