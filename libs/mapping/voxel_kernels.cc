#include "mapping/voxel_kernels.h"

#include <algorithm>
#include <cmath>

#include "geometry/vector_clones.h"

namespace vismap {
namespace {

// Position of each voxel in its block along the three axes, as numbers.
struct Ramps {
  alignas(64) float i[kBlockVoxels] = {}, j[kBlockVoxels] = {}, k[kBlockVoxels] = {};
  constexpr Ramps() {
    for (int voxel = 0; voxel < kBlockVoxels; ++voxel) {
      i[voxel] = static_cast<float>(voxel % kBlockSide);
      j[voxel] = static_cast<float>(voxel / kBlockSide % kBlockSide);
      k[voxel] = static_cast<float>(voxel / (kBlockSide * kBlockSide));
    }
  }
};
constexpr Ramps kRamps;

// Plain arrays and scalars only: what these loops see decides whether they vectorise.
VISMAP_VECTOR_CLONES void Project(const float* first, const float* step, const float* intrinsics,
                                  float* __restrict z_out, float* __restrict u_out,
                                  float* __restrict v_out, float* __restrict stretch_out) {
  const float fx = intrinsics[0], fy = intrinsics[1], cx = intrinsics[2], cy = intrinsics[3];
  const float x0 = first[0], y0 = first[1], z0 = first[2];
  const float xi = step[0], yi = step[1], zi = step[2];
  const float xj = step[3], yj = step[4], zj = step[5];
  const float xk = step[6], yk = step[7], zk = step[8];
  for (int voxel = 0; voxel < kBlockVoxels; ++voxel) {
    const float i = kRamps.i[voxel], j = kRamps.j[voxel], k = kRamps.k[voxel];
    const float x = x0 + xj * j + xk * k + xi * i;
    const float y = y0 + yj * j + yk * k + yi * i;
    const float z = z0 + zj * j + zk * k + zi * i;
    const float a = x / z, b = y / z;
    z_out[voxel] = z;
    u_out[voxel] = fx * a + cx;
    v_out[voxel] = fy * b + cy;
    stretch_out[voxel] = std::sqrt(a * a + b * b + 1.0F);
  }
}

// Conditions are floats, 0 or 1, since that is what vectorises.
VISMAP_VECTOR_CLONES void Judge(const float* z_in, const float* stretch, const float* depth_in,
                                const MeasurementLimits& limits, float* __restrict distance_out,
                                float* __restrict weight_out, float* __restrict near_out,
                                float* __restrict free_out) {
  const float truncation = limits.truncation, min_range = limits.min_range,
              max_range = limits.max_range;
  const float free_range = limits.free_space ? limits.free_space_range : -1.0F;
  const float drop_off = limits.drop_off_start, drop_scale = 1.0F / (truncation + drop_off);
  for (int i = 0; i < kBlockVoxels; ++i) {
    const float depth = depth_in[i], z = z_in[i];
    const float distance = (depth - z) * stretch[i];
    const float measured = depth >= min_range ? 1.0F : 0.0F;
    const float in_range = z >= min_range ? measured : 0.0F;
    const float seen = distance >= -truncation ? in_range : 0.0F;
    const float free_here = z <= free_range ? seen : 0.0F;
    const float near_here = depth <= max_range ? seen : 0.0F;
    const float is_free = distance >= truncation ? free_here : 0.0F;
    const float is_near = distance < truncation ? near_here : 0.0F;
    const float said = is_free + is_near;
    const float bounded =
        depth > 0.5F ? depth : 0.5F;  // nearer than half a metre no sensor gets better
    const float inverse = 1.0F / bounded;
    const float faded = (truncation + distance) * drop_scale;
    const float fading = faded < 1.0F ? faded : 1.0F;
    const float exact = inverse * inverse * fading * kWeightScale;
    const float weight = exact > 1.0F ? exact : 1.0F;
    const float clamped = distance < truncation ? distance : truncation;
    weight_out[i] = said > 0.0F ? weight : 0.0F;
    distance_out[i] = said > 0.0F ? clamped : 0.0F;
    near_out[i] = is_near;
    free_out[i] = is_free;
  }
}

VISMAP_VECTOR_CLONES void Fuse(const float* distance_in, const float* weight_in, float scale,
                               float max_weight, int16_t* distances, uint16_t* weights,
                               uint8_t* observations, float* shares) {
  for (int i = 0; i < kBlockVoxels; ++i) {
    const float old_weight = weights[i], weight = weight_in[i], old_distance = distances[i];
    const float share = weight / std::max(old_weight + weight, 1.0F);
    const float fused = old_distance + share * (distance_in[i] * scale - old_distance);
    // Rounding to nearest by truncation of a positive number; exact for values that do not change.
    distances[i] = static_cast<int16_t>(static_cast<int32_t>(fused + 32768.5F) - 32768);
    weights[i] = static_cast<uint16_t>(
        static_cast<int32_t>(std::min(old_weight + weight, max_weight) + 0.5F));
    const int count = observations[i] + (weight > 0 ? 1 : 0);
    observations[i] = static_cast<uint8_t>(std::min(count, 255));
    shares[i] = share;
  }
}

}  // namespace

void ProjectVoxels(const VoxelLattice& lattice, const PinholeCamera& camera, ProjectedVoxels& out) {
  // Half a pixel is added here, so that truncation rounds.
  const float intrinsics[4] = {static_cast<float>(camera.fx), static_cast<float>(camera.fy),
                               static_cast<float>(camera.cx) + 0.5F,
                               static_cast<float>(camera.cy) + 0.5F};
  Project(lattice.first_C.data(), lattice.step_C.data(), intrinsics, out.z.data(), out.u.data(),
          out.v.data(), out.stretch.data());
}

void JudgeVoxels(const ProjectedVoxels& voxels, const VoxelArray<float>& depth,
                 const MeasurementLimits& limits, VoxelSamples& out) {
  Judge(voxels.z.data(), voxels.stretch.data(), depth.data(), limits, out.distance.data(),
        out.weight.data(), out.near.data(), out.free.data());
}

void FuseDistances(const VoxelSamples& samples, float truncation, float max_weight,
                   SurfaceVoxels& voxels, VoxelArray<float>& shares) {
  Fuse(samples.distance.data(), samples.weight.data(), 32767.0F / truncation, max_weight,
       voxels.distance.data(), voxels.weight.data(), voxels.observations.data(), shares.data());
}

}  // namespace vismap
