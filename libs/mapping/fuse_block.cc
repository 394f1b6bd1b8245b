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

// Flags are 0 or 1.
bool Any(const VoxelArray<float>& flags) {
  float sum = 0;
  for (const float flag : flags) sum += flag;
  return sum > 0;
}

std::array<uint64_t, kBlockVoxels / 64> Bits(const VoxelArray<float>& flags) {
  std::array<uint64_t, kBlockVoxels / 64> bits{};
  for (size_t i = 0; i < kBlockVoxels; ++i)
    bits[i / 64] |= static_cast<uint64_t>(flags[i] > 0) << (i % 64);
  return bits;
}

}  // namespace

FrameProjection::FrameProjection(const SegmentedFrame& frame, std::vector<SegmentLabel> labels,
                                 const IntegrationOptions& options, const VoxelGridOptions& grid)
    : frame_(frame), labels_(std::move(labels)), voxel_size_(grid.voxel_size) {
  const Pose T_C_W = frame.frame.header.T_W_C.inverse();
  R_C_W_ = T_C_W.linear();
  t_C_W_ = T_C_W.translation();
  limits_ = {static_cast<float>(grid.truncation_voxels * grid.voxel_size),
             static_cast<float>(options.min_range),
             static_cast<float>(options.max_range),
             static_cast<float>(options.free_space_range),
             -static_cast<float>(grid.voxel_size),
             options.free_space};
  max_weight_ = static_cast<float>(options.max_weight) * kWeightScale;
  vote_distance_ = static_cast<float>(options.vote_distance_voxels * grid.voxel_size);
  color_distance_ =
      static_cast<float>(2 * grid.voxel_size);  // all that a mesh vertex can lie between
}

void FrameProjection::LookUpDepth(const ProjectedVoxels& voxels, VoxelArray<float>& depth,
                                  VoxelArray<int32_t>& pixel) const {
  const Image<float>& image = frame_.frame.depth;
  const auto width = static_cast<float>(image.width()), height = static_cast<float>(image.height());
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    depth[i] = 0;
    pixel[i] = 0;
    const float u = voxels.u[i], v = voxels.v[i];
    if (!(voxels.z[i] > 0 && u >= 0 && v >= 0 && u < width && v < height)) continue;
    pixel[i] = static_cast<int32_t>(v) * image.width() + static_cast<int32_t>(u);
    const float measured = image.data()[pixel[i]];
    depth[i] = measured > 0 ? measured : 0.0F;  // NaN becomes 0
  }
}

void FrameProjection::BlendColors(const VoxelSamples& samples, const VoxelArray<int32_t>& pixel,
                                  const VoxelArray<float>& shares, SurfaceVoxels& voxels) const {
  if (frame_.frame.color.empty()) return;
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    if (samples.near[i] == 0 || std::abs(samples.distance[i]) > color_distance_) continue;
    const Rgb8 seen = frame_.frame.color.data()[pixel[i]];
    Rgb8& color = voxels.color[i];
    // A voxel that was only seen from farther off has no colour yet.
    const float share = color == Rgb8{} ? 1.0F : shares[i];
    color = {Blend(color.r, seen.r, share), Blend(color.g, seen.g, share),
             Blend(color.b, seen.b, share)};
  }
}

int64_t FrameProjection::Vote(const VoxelSamples& samples, const VoxelArray<int32_t>& pixel,
                              SurfaceVoxels& voxels) const {
  int64_t evicted = 0;
  SegmentLabel last = SegmentLabel::kNone;
  uint8_t entry = 0;
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    if (samples.near[i] == 0 || std::abs(samples.distance[i]) > vote_distance_) continue;
    const SegmentIndex segment = frame_.image.index.data()[pixel[i]];
    if (segment == SegmentIndex::kNone) continue;
    const SegmentLabel label = labels_[static_cast<size_t>(Raw(segment))];
    if (label == SegmentLabel::kNone) continue;
    if (label != last) {
      entry = PaletteEntry(voxels, label);
      last = label;
    }
    if (!AddVoteForEntry(voxels, static_cast<int>(i), entry)) ++evicted;
  }
  return evicted;
}

FrameProjection::Outcome FrameProjection::FuseSurface(const VoxelSamples& samples,
                                                      const VoxelArray<int32_t>& pixel,
                                                      SurfaceVoxels& voxels) const {
  Outcome outcome;
  outcome.voxels_updated =
      std::count_if(samples.weight.begin(), samples.weight.end(), [](float w) { return w > 0; });
  if (outcome.voxels_updated == 0) return outcome;
  alignas(64) VoxelArray<float> shares;
  FuseDistances(samples, limits_.truncation, max_weight_, voxels, shares);
  BlendColors(samples, pixel, shares, voxels);
  outcome.votes_evicted = Vote(samples, pixel, voxels);
  outcome.changed = true;
  return outcome;
}

FrameProjection::Outcome FrameProjection::Fuse(BlockIndex index, BlockView view,
                                               Block& block) const {
  if (view == BlockView::kWhollyFree && !block.surface) {
    static constexpr std::array<uint64_t, kBlockVoxels / 64> kAll{~0ull, ~0ull, ~0ull, ~0ull,
                                                                  ~0ull, ~0ull, ~0ull, ~0ull};
    return {MarkFree(kAll, block), 0, 0};
  }
  const Eigen::Vector3d first_W =
      Eigen::Vector3d(index.x, index.y, index.z) * (kBlockSide * voxel_size_) +
      Eigen::Vector3d::Constant(0.5 * voxel_size_);
  const VoxelLattice lattice{(R_C_W_ * first_W + t_C_W_).cast<float>(),
                             (R_C_W_ * voxel_size_).cast<float>()};
  ProjectedVoxels voxels;
  ProjectVoxels(lattice, frame_.frame.header.camera, voxels);
  alignas(64) VoxelArray<float> depth;
  alignas(64) VoxelArray<int32_t> pixel;
  LookUpDepth(voxels, depth, pixel);
  VoxelSamples samples;
  JudgeVoxels(voxels, depth, limits_, samples);
  if (!block.surface && !Any(samples.near)) {
    return {Any(samples.free) && MarkFree(Bits(samples.free), block), 0, 0};
  }
  if (!block.surface) {
    block.surface = Densify(block);
    block.free.reset();
    block.all_free = false;
  }
  return FuseSurface(samples, pixel, *block.surface);
}

}  // namespace vismap
