#include "mapping/voxel_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

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

// Plain arrays and scalars only: what these loops see decides whether they vectorise. Conditions
// are floats, 0 or 1, for the same reason.
VISMAP_VECTOR_CLONES void Project(const float* first, const float* step, const float* camera,
                                  float* __restrict z_out, int32_t* __restrict pixel_out,
                                  float* __restrict inside_out, float* __restrict stretch_out) {
  const float fx = camera[0], fy = camera[1], cx = camera[2], cy = camera[3];
  const float width = camera[4], height = camera[5];
  const auto row = static_cast<int32_t>(width);
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
    const float u = fx * a + cx, v = fy * b + cy;
    const float before = z > 0 ? 1.0F : 0.0F;
    const float right = u >= 0 ? before : 0.0F, left = u < width ? right : 0.0F;
    const float below = v >= 0 ? left : 0.0F, inside = v < height ? below : 0.0F;
    const float whole_u = inside > 0 ? u : 0.0F, whole_v = inside > 0 ? v : 0.0F;
    z_out[voxel] = z;
    pixel_out[voxel] = static_cast<int32_t>(whole_v) * row + static_cast<int32_t>(whole_u);
    inside_out[voxel] = inside;
    stretch_out[voxel] = std::sqrt(a * a + b * b + 1.0F);
  }
}

VISMAP_VECTOR_CLONES void Gather(const int32_t* pixel, const float* inside, const float* image,
                                 float* __restrict depth_out) {
  for (int voxel = 0; voxel < kBlockVoxels; ++voxel) {
    const float measured = image[pixel[voxel]];
    const float known = measured > 0 ? measured : 0.0F;  // NaN becomes 0
    depth_out[voxel] = inside[voxel] > 0 ? known : 0.0F;
  }
}

VISMAP_VECTOR_CLONES void Judge(const float* z_in, const float* stretch, const float* depth_in,
                                const MeasurementLimits& limits, float* __restrict distance_out,
                                float* __restrict said_out, uint8_t* __restrict flags_out) {
  const float truncation = limits.truncation, min_range = limits.min_range,
              max_range = limits.max_range;
  const float free_range = limits.free_space ? limits.free_space_range : -1.0F;
  const float vote = limits.vote_distance, color = limits.color_distance;
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
    const float clamped = distance < truncation ? distance : truncation;
    const float gap = std::abs(distance);
    const float votes = gap <= vote ? is_near : 0.0F;
    const float colors = gap <= color ? is_near : 0.0F;
    said_out[i] = said;
    distance_out[i] = said > 0.0F ? clamped : 0.0F;
    flags_out[i] = static_cast<uint8_t>(static_cast<int32_t>(
        is_near * static_cast<float>(kNearSurface) + is_free * static_cast<float>(kSeenFree) +
        votes * static_cast<float>(kTakesVote) + colors * static_cast<float>(kTakesColor)));
  }
}

VISMAP_VECTOR_CLONES void Weigh(const float* depth_in, const float* distance_in, float truncation,
                                float drop_off, float* __restrict weights) {
  const float drop_scale = 1.0F / (truncation + drop_off);
  for (int i = 0; i < kBlockVoxels; ++i) {
    const float depth = depth_in[i];
    const float bounded =
        depth > 0.5F ? depth : 0.5F;  // nearer than half a metre no sensor gets better
    const float inverse = 1.0F / bounded;
    const float faded = (truncation + distance_in[i]) * drop_scale;
    const float fading = faded < 1.0F ? faded : 1.0F;
    const float exact = inverse * inverse * fading * kWeightScale;
    const float weight = exact > 1.0F ? exact : 1.0F;
    weights[i] = weights[i] > 0.0F ? weight : 0.0F;
  }
}

// A mean distance of nine tenths of the truncation or more is one of free space.
constexpr float kFreeSteps = 9 * kTruncationSteps / 10;

VISMAP_VECTOR_CLONES void Fuse(const float* distance_in, const float* weight_in, float scale,
                               float max_weight, float free_frames, int16_t* distances,
                               uint16_t* weights, uint8_t* observations, float* shares) {
  for (int i = 0; i < kBlockVoxels; ++i) {
    const float old_weight = weights[i], weight = weight_in[i], old_distance = distances[i];
    const float share = weight / std::max(old_weight + weight, 1.0F);
    const float fused = old_distance + share * (distance_in[i] * scale - old_distance);
    // Rounding to nearest by truncation of a positive number; exact for values that do not change.
    distances[i] = static_cast<int16_t>(static_cast<int32_t>(fused + 32768.5F) - 32768);
    const float sum = std::min(old_weight + weight, max_weight);
    const float cap = free_frames * weight;
    const float bounded = cap < sum ? cap : sum;
    const float at_free = weight > 0 ? bounded : sum;
    const float left = fused >= kFreeSteps ? at_free : sum;
    weights[i] = static_cast<uint16_t>(static_cast<int32_t>(left + 0.5F));
    const int count = observations[i] + (weight > 0 ? 1 : 0);
    observations[i] = static_cast<uint8_t>(std::min(count, 255));
    shares[i] = share;
  }
}

// Whether any voxel has a frame's weight, one of its own, a distance below a limit and a measured
// one from another limit on.
VISMAP_VECTOR_CLONES int32_t CountPassable(const float* distance_in, const float* weight_in,
                                           float min_measured, float max_distance,
                                           const int16_t* distances, const uint16_t* weights) {
  int32_t count = 0;
  for (int i = 0; i < kBlockVoxels; ++i) {
    const float old_distance = distances[i], old_weight = weights[i];
    const int32_t measured = distance_in[i] >= min_measured ? 1 : 0;
    const int32_t said = weight_in[i] > 0 ? measured : 0;
    const int32_t known = old_weight > 0 ? said : 0;
    count += old_distance < max_distance ? known : 0;
  }
  return count;
}

VISMAP_VECTOR_CLONES void Carve(const float* z, const float* clear, float metres,
                                const CarvingLimits& limits, float* weight_in,
                                const int16_t* distances, uint16_t* weights,
                                uint8_t* __restrict turning) {
  const float frames = limits.frames, keep = limits.keep, slope = limits.slope;
  const float max_distance = limits.max_distance;
  for (int i = 0; i < kBlockVoxels; ++i) {
    const float distance = static_cast<float>(distances[i]) * metres;
    const float old_weight = weights[i], weight = weight_in[i];
    const float before = distance > 0 ? distance : 0.0F;
    const float behind = clear[i] - z[i];
    const float near_here = distance < max_distance ? 1.0F : 0.0F;
    const float said = weight > 0 ? near_here : 0.0F;
    const float known = old_weight > 0 ? said : 0.0F;
    const float passed = behind > slope * before ? known : 0.0F;
    const float least = frames * weight, most = least + 2.0F * weight;
    const float heavy = old_weight > most ? passed : 0.0F;
    const float kept = old_weight * keep;
    const float weakened = kept > least ? kept : least;
    const float capped = old_weight < least ? old_weight : least;
    const float light = passed > heavy ? capped : old_weight;
    const float left = heavy > 0 ? weakened : light;
    weights[i] = static_cast<uint16_t>(static_cast<int32_t>(left + 0.5F));
    weight_in[i] = heavy > 0 ? 0.0F : weight;
    const float inside = distance <= 0 ? passed - heavy : 0.0F;
    turning[i] = static_cast<uint8_t>(static_cast<int32_t>(inside));
  }
}

}  // namespace

void ProjectVoxels(const VoxelLattice& lattice, const PinholeCamera& camera, ProjectedVoxels& out) {
  // Half a pixel is added here, so that truncation rounds.
  const float intrinsics[6] = {
      static_cast<float>(camera.fx),        static_cast<float>(camera.fy),
      static_cast<float>(camera.cx) + 0.5F, static_cast<float>(camera.cy) + 0.5F,
      static_cast<float>(camera.width),     static_cast<float>(camera.height)};
  Project(lattice.first_C.data(), lattice.step_C.data(), intrinsics, out.z.data(), out.pixel.data(),
          out.inside.data(), out.stretch.data());
}

void LookUpDepth(const ProjectedVoxels& voxels, const float* image, VoxelArray<float>& depth) {
  Gather(voxels.pixel.data(), voxels.inside.data(), image, depth.data());
}

void JudgeVoxels(const ProjectedVoxels& voxels, const VoxelArray<float>& depth,
                 const MeasurementLimits& limits, VoxelSamples& out) {
  Judge(voxels.z.data(), voxels.stretch.data(), depth.data(), limits, out.distance.data(),
        out.weight.data(), out.flags.data());
}

void WeighVoxels(const VoxelArray<float>& depth, const MeasurementLimits& limits,
                 VoxelSamples& samples) {
  Weigh(depth.data(), samples.distance.data(), limits.truncation, limits.drop_off_start,
        samples.weight.data());
}

namespace {
uint64_t EightFlags(const VoxelArray<uint8_t>& flags, size_t first) {
  uint64_t eight;
  std::memcpy(&eight, flags.data() + first, sizeof(eight));
  return eight;
}
}  // namespace

VoxelBits VoxelsWith(const VoxelArray<uint8_t>& flags, uint8_t mask) {
  VoxelBits bits{};
  for (size_t i = 0; i < kBlockVoxels; i += 8) {
    uint64_t hit = EightFlags(flags, i) & (mask * 0x0101010101010101u);
    if (hit == 0) continue;
    // Every byte to 0 or 1 (flags stay below 128), then the eight of them side by side.
    hit = ((hit + 0x7F7F7F7F7F7F7F7Fu) >> 7) & 0x0101010101010101u;
    bits[i / 64] |= ((hit * 0x0102040810204080u) >> 56) << (i % 64);
  }
  return bits;
}

uint8_t UnionOf(const VoxelArray<uint8_t>& flags) {
  uint64_t all = 0;
  for (size_t i = 0; i < kBlockVoxels; i += 8) all |= EightFlags(flags, i);
  all |= all >> 32;
  all |= all >> 16;
  all |= all >> 8;
  return static_cast<uint8_t>(all);
}

void FuseDistances(const VoxelSamples& samples, float truncation, const WeightLimits& limits,
                   SurfaceVoxels& voxels, VoxelArray<float>& shares) {
  Fuse(samples.distance.data(), samples.weight.data(), kTruncationSteps / truncation, limits.most,
       limits.free_frames, voxels.distance.data(), voxels.weight.data(), voxels.observations.data(),
       shares.data());
}

bool MayCarve(const VoxelSamples& samples, float truncation, const CarvingLimits& limits,
              const SurfaceVoxels& voxels) {
  return CountPassable(samples.distance.data(), samples.weight.data(), limits.min_measured,
                       limits.max_distance * (kTruncationSteps / truncation),
                       voxels.distance.data(), voxels.weight.data()) > 0;
}

VoxelBits CarveVoxels(const ProjectedVoxels& projected, const VoxelArray<float>& clear,
                      float truncation, const CarvingLimits& limits, VoxelSamples& samples,
                      SurfaceVoxels& voxels) {
  alignas(64) VoxelArray<uint8_t> turning;
  Carve(projected.z.data(), clear.data(), truncation / kTruncationSteps, limits,
        samples.weight.data(), voxels.distance.data(), voxels.weight.data(), turning.data());
  return VoxelsWith(turning, 1);
}

}  // namespace vismap
