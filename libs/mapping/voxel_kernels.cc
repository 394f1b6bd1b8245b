#include "mapping/voxel_kernels.h"

#include <algorithm>
#include <cmath>

#include "geometry/vector_clones.h"

namespace vismap {
namespace {

constexpr float kRamp[kBlockSide] = {0, 1, 2, 3, 4, 5, 6, 7};

// Plain arrays and scalars only: what these loops see decides whether they vectorise.
VISMAP_VECTOR_CLONES void Project(const float* first, const float* step, const float* intrinsics,
                                  float* z_out, float* u_out, float* v_out, float* stretch_out) {
  const float fx = intrinsics[0], fy = intrinsics[1], cx = intrinsics[2], cy = intrinsics[3];
  for (int row = 0; row < kBlockSide * kBlockSide; ++row) {
    const auto j = static_cast<float>(row % kBlockSide), k = static_cast<float>(row / kBlockSide);
    const float x0 = first[0] + step[3] * j + step[6] * k;
    const float y0 = first[1] + step[4] * j + step[7] * k;
    const float z0 = first[2] + step[5] * j + step[8] * k;
    float* z_row = z_out + row * kBlockSide;
    float* u_row = u_out + row * kBlockSide;
    float* v_row = v_out + row * kBlockSide;
    float* stretch_row = stretch_out + row * kBlockSide;
    for (int i = 0; i < kBlockSide; ++i) {
      const float x = x0 + step[0] * kRamp[i], y = y0 + step[1] * kRamp[i],
                  z = z0 + step[2] * kRamp[i];
      const float a = x / z, b = y / z;
      z_row[i] = z;
      u_row[i] = fx * a + cx;
      v_row[i] = fy * b + cy;
      stretch_row[i] = std::sqrt(a * a + b * b + 1.0F);
    }
  }
}

VISMAP_VECTOR_CLONES void Judge(const float* z_in, const float* stretch, const float* depth_in,
                                const MeasurementLimits& limits, float* distance_out,
                                float* weight_out, uint8_t* near_out, uint8_t* free_out) {
  const float truncation = limits.truncation, min_range = limits.min_range,
              max_range = limits.max_range;
  const float free_range = limits.free_space ? limits.free_space_range : -1.0F;
  const float drop_off = limits.drop_off_start, drop_scale = 1.0F / (truncation + drop_off);
  for (int i = 0; i < kBlockVoxels; ++i) {
    const float depth = depth_in[i], z = z_in[i];
    const float distance = (depth - z) * stretch[i];
    const bool seen = (depth >= min_range) & (z >= min_range) & (distance >= -truncation);
    const bool before = distance >= truncation;
    const bool is_free = seen & before & (z <= free_range);
    const bool is_near = seen & !before & (depth <= max_range);
    const float inverse =
        1.0F / std::max(depth, 0.5F);  // nearer than half a metre no sensor gets better
    const float fading = std::min(1.0F, (truncation + distance) * drop_scale);
    const float weight = std::max(inverse * inverse * fading * kWeightScale, 1.0F);
    weight_out[i] = (is_free | is_near) ? weight : 0.0F;
    distance_out[i] = (is_free | is_near) ? std::min(distance, truncation) : 0.0F;
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
