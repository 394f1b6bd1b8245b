#include "mapping/fuse_block.h"

#include <algorithm>
#include <cmath>

#include "volume/label_votes.h"

namespace vismap {
namespace {

// Sets the bits of `seen` in the free-space record; true when that changed anything. A full record
// becomes all_free.
bool MarkFree(const std::array<uint64_t, kBlockVoxels / 64>& seen, Block& block) {
  if (block.all_free) return false;
  if (!block.free) block.free = std::make_unique<FreeVoxels>();
  bool changed = false, full = true;
  for (size_t word = 0; word < seen.size(); ++word) {
    uint64_t& once = block.free->once[word];
    uint64_t& twice = block.free->twice[word];
    const uint64_t new_once = once | seen[word], new_twice = twice | (once & seen[word]);
    changed = changed || new_once != once || new_twice != twice;
    once = new_once;
    twice = new_twice;
    full = full && twice == ~uint64_t{0};
  }
  if (full) {
    block.free.reset();
    block.all_free = true;
  }
  return changed;
}

// A surface came near: the free-space record becomes dense voxels that remember how often they were
// seen empty.
std::unique_ptr<SurfaceVoxels> Densify(const Block& block) {
  auto voxels = std::make_unique<SurfaceVoxels>();
  for (int i = 0; i < kBlockVoxels; ++i) {
    int observations = 0;
    if (block.all_free) observations = 2;
    if (block.free) observations = block.free->SeenTwice(i) ? 2 : block.free->SeenOnce(i) ? 1 : 0;
    if (observations == 0) continue;
    const auto at = static_cast<size_t>(i);
    voxels->distance[at] = 32767;
    voxels->observations[at] = static_cast<uint8_t>(observations);
    voxels->weight[at] =
        static_cast<uint16_t>(static_cast<float>(observations) * kWeightScale * 0.25F);
  }
  return voxels;
}

uint8_t Blend(uint8_t old_value, uint8_t new_value, float share) {
  const float blended = static_cast<float>(old_value) +
                        share * (static_cast<float>(new_value) - static_cast<float>(old_value));
  return static_cast<uint8_t>(blended + 0.5F);
}

}  // namespace

// What the frame says of each voxel of a block.
struct FrameProjection::Samples {
  std::array<float, kBlockVoxels>
      distance;  // signed, along the ray [m]; NaN = the frame says nothing
  std::array<float, kBlockVoxels> weight;
  std::array<int32_t, kBlockVoxels> pixel;         // linear index of the pixel
  std::array<uint64_t, kBlockVoxels / 64> free{};  // farther than the truncation before a surface
  bool near_surface = false;
  bool any_free = false;
};

FrameProjection::FrameProjection(const SegmentedFrame& frame, std::vector<SegmentLabel> labels,
                                 const IntegrationOptions& options, const VoxelGridOptions& grid)
    : frame_(frame), labels_(std::move(labels)), voxel_size_(grid.voxel_size) {
  const Pose T_C_W = frame.frame.header.T_W_C.inverse();
  R_C_W_ = T_C_W.linear();
  t_C_W_ = T_C_W.translation();
  truncation_ = static_cast<float>(grid.truncation_voxels * grid.voxel_size);
  min_range_ = static_cast<float>(options.min_range);
  max_range_ = static_cast<float>(options.max_range);
  free_space_range_ = static_cast<float>(options.free_space_range);
  max_weight_ = static_cast<float>(options.max_weight) * kWeightScale;
  vote_distance_ = static_cast<float>(options.vote_distance_voxels * grid.voxel_size);
  drop_off_start_ = -static_cast<float>(grid.voxel_size);
  free_space_ = options.free_space;
  const PinholeCamera& camera = frame.frame.header.camera;
  ray_length_ = Image<float>(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      ray_length_(v, u) = static_cast<float>(camera.BackProject(u, v, 1.0).norm());
    }
  }
}

void FrameProjection::SampleVoxel(float x, float y, float z, int voxel, Samples& samples) const {
  const auto i = static_cast<size_t>(voxel);
  samples.distance[i] = std::numeric_limits<float>::quiet_NaN();
  if (z < min_range_) return;
  const PinholeCamera& camera = frame_.frame.header.camera;
  const float u_exact =
      static_cast<float>(camera.fx) * x / z + static_cast<float>(camera.cx) + 0.5F;
  const float v_exact =
      static_cast<float>(camera.fy) * y / z + static_cast<float>(camera.cy) + 0.5F;
  if (!(u_exact >= 0 && v_exact >= 0 && u_exact < static_cast<float>(camera.width) &&
        v_exact < static_cast<float>(camera.height))) {
    return;
  }
  const int u = static_cast<int>(u_exact), v = static_cast<int>(v_exact);
  const float depth = frame_.frame.depth(v, u);
  if (!(depth >= min_range_)) return;
  const float distance = (depth - z) * ray_length_(v, u);
  if (distance < -truncation_) return;
  const bool is_free = distance >= truncation_;
  if (is_free ? !free_space_ || z > free_space_range_ : depth > max_range_) return;
  samples.distance[i] = std::min(distance, truncation_);
  const float inverse =
      1.0F / std::max(depth, 0.5F);  // nearer than half a metre no sensor gets better
  float weight = inverse * inverse;
  if (distance < drop_off_start_)
    weight *= (truncation_ + distance) / (truncation_ + drop_off_start_);
  samples.weight[i] = weight * kWeightScale;
  samples.pixel[i] = v * camera.width + u;
  if (is_free) {
    samples.free[i / 64] |= uint64_t{1} << (i % 64);
    samples.any_free = true;
  } else {
    samples.near_surface = true;
  }
}

void FrameProjection::Sample(BlockIndex index, Samples& samples) const {
  const Eigen::Vector3d low =
      Eigen::Vector3d(index.x, index.y, index.z) * (kBlockSide * voxel_size_);
  const Eigen::Vector3f first =
      (R_C_W_ * (low + Eigen::Vector3d::Constant(0.5 * voxel_size_)) + t_C_W_).cast<float>();
  const Eigen::Matrix3f step = (R_C_W_ * voxel_size_).cast<float>();
  int voxel = 0;
  for (int k = 0; k < kBlockSide; ++k) {
    for (int j = 0; j < kBlockSide; ++j) {
      const auto kf = static_cast<float>(k), jf = static_cast<float>(j);
      const float row_x = first.x() + step(0, 1) * jf + step(0, 2) * kf;
      const float row_y = first.y() + step(1, 1) * jf + step(1, 2) * kf;
      const float row_z = first.z() + step(2, 1) * jf + step(2, 2) * kf;
      for (int i = 0; i < kBlockSide; ++i, ++voxel) {
        const auto fi = static_cast<float>(i);
        SampleVoxel(row_x + step(0, 0) * fi, row_y + step(1, 0) * fi, row_z + step(2, 0) * fi,
                    voxel, samples);
      }
    }
  }
}

void FrameProjection::FuseVoxel(const Samples& samples, size_t i, SurfaceVoxels& voxels) const {
  const float old_weight = voxels.weight[i];
  const float weight = std::max(samples.weight[i], 1.0F);
  const float share = weight / (old_weight + weight);
  const float measured = samples.distance[i] * (32767.0F / truncation_);
  const float old_distance = voxels.distance[i];
  voxels.distance[i] =
      static_cast<int16_t>(std::floor(old_distance + share * (measured - old_distance) + 0.5F));
  voxels.weight[i] = static_cast<uint16_t>(std::min(old_weight + weight, max_weight_) + 0.5F);
  if (voxels.observations[i] < 255) ++voxels.observations[i];
  if (std::abs(samples.distance[i]) < truncation_ && !frame_.frame.color.empty()) {
    const Rgb8 seen = frame_.frame.color.pixels()[static_cast<size_t>(samples.pixel[i])];
    Rgb8& color = voxels.color[i];
    color = {Blend(color.r, seen.r, share), Blend(color.g, seen.g, share),
             Blend(color.b, seen.b, share)};
  }
}

FrameProjection::Outcome FrameProjection::FuseSurface(const Samples& samples,
                                                      SurfaceVoxels& voxels) const {
  Outcome outcome;
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    const float distance = samples.distance[i];
    if (distance != distance) continue;
    FuseVoxel(samples, i, voxels);
    ++outcome.voxels_updated;
    if (std::abs(distance) > vote_distance_) continue;
    const SegmentIndex segment = frame_.image.index.pixels()[static_cast<size_t>(samples.pixel[i])];
    if (segment == SegmentIndex::kNone) continue;
    const SegmentLabel label = labels_[static_cast<size_t>(Raw(segment))];
    if (label == SegmentLabel::kNone) continue;
    if (!AddVote(voxels, static_cast<int>(i), label)) ++outcome.votes_evicted;
  }
  outcome.changed = outcome.voxels_updated > 0;
  return outcome;
}

FrameProjection::Outcome FrameProjection::Fuse(BlockIndex index, bool wholly_free,
                                               Block& block) const {
  if (wholly_free && !block.surface) {
    static constexpr std::array<uint64_t, kBlockVoxels / 64> kAll{~0ull, ~0ull, ~0ull, ~0ull,
                                                                  ~0ull, ~0ull, ~0ull, ~0ull};
    return {MarkFree(kAll, block), 0, 0};
  }
  Samples samples;
  Sample(index, samples);
  if (!block.surface && !samples.near_surface) {
    return {samples.any_free && MarkFree(samples.free, block), 0, 0};
  }
  if (!block.surface) {
    block.surface = Densify(block);
    block.free.reset();
    block.all_free = false;
  }
  return FuseSurface(samples, *block.surface);
}

}  // namespace vismap
