#include "mapping/fuse_block.h"

#include <algorithm>
#include <bit>

#include "base/prefetch.h"
#include "map/label_votes.h"
#include "mapping/clear_depth.h"

namespace vismap {
namespace {

// Counts the voxels in `seen` as seen empty once more; returns those whose bits changed. A block
// whose voxels were all seen empty twice becomes all_free.
VoxelBits MarkFree(const VoxelBits& seen, Block& block) {
  VoxelBits changed{};
  if (block.all_free) return changed;
  if (!block.free) block.free = Shared<FreeVoxels>::Make();
  FreeVoxels& free = block.free.Own();
  bool full = true;
  for (size_t word = 0; word < seen.size(); ++word) {
    uint64_t& once = free.once[word];
    uint64_t& twice = free.twice[word];
    const uint64_t new_once = once | seen[word], new_twice = twice | (once & seen[word]);
    changed[word] = (new_once ^ once) | (new_twice ^ twice);
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

// The voxels of a block of free space that a surface comes near to: they keep how often they were
// seen empty.
Shared<SurfaceVoxels> Densify(const Block& block) {
  auto shared = Shared<SurfaceVoxels>::Make();
  SurfaceVoxels& voxels = shared.Own();
  for (int i = 0; i < kBlockVoxels; ++i) {
    int observations = 0;
    if (block.all_free) observations = 2;
    if (block.free) observations = block.free->SeenTwice(i) ? 2 : block.free->SeenOnce(i) ? 1 : 0;
    if (observations == 0) continue;
    const auto at = static_cast<size_t>(i);
    voxels.distance[at] = kTruncationSteps;
    voxels.observations[at] = static_cast<uint8_t>(observations);
    voxels.weight[at] =
        static_cast<uint16_t>(static_cast<float>(observations) * kWeightScale * 0.25F);
  }
  return shared;
}

uint8_t Blend(uint8_t old_value, uint8_t new_value, float share) {
  const float blended = static_cast<float>(old_value) +
                        share * (static_cast<float>(new_value) - static_cast<float>(old_value));
  return static_cast<uint8_t>(blended + 0.5F);
}

// Calls visit(voxel) for every bit set, ascending.
template <typename Visit>
void ForEach(const VoxelBits& bits, const Visit& visit) {
  for (size_t word = 0; word < bits.size(); ++word) {
    for (uint64_t rest = bits[word]; rest != 0; rest &= rest - 1)
      visit(word * 64 + static_cast<size_t>(std::countr_zero(rest)));
  }
}

// Voxels at this distance from the surface or farther are not carved [truncations]: there the mean
// itself soon becomes that of free space.
constexpr float kCarvedPart = 0.75F;

MeasurementLimits LimitsOf(const IntegrationOptions& options, const VoxelGridOptions& grid) {
  return {.truncation = static_cast<float>(grid.truncation_voxels * grid.voxel_size_m),
          .min_range = static_cast<float>(options.min_range_m),
          .max_range = static_cast<float>(options.max_range_m),
          .free_space_range = static_cast<float>(options.free_space_range_m),
          .drop_off_start = -static_cast<float>(grid.voxel_size_m),
          .vote_distance = static_cast<float>(options.vote_distance_voxels * grid.voxel_size_m),
          // A mesh vertex lies between voxels that are at most this far from the surface.
          .color_distance = static_cast<float>(2 * grid.voxel_size_m),
          .free_space = options.free_space};
}

WeightLimits WeightLimitsOf(const IntegrationOptions& options) {
  // A frame weighs at least one step, so that this many times its weight exceeds every weight.
  constexpr float kNoLimit = 65536.0F;
  return {.most = static_cast<float>(options.max_weight) * kWeightScale,
          .free_frames = options.free_frames > 0
                             ? std::max(static_cast<float>(options.free_frames), 1.0F)
                             : kNoLimit};
}

CarvingLimits CarvingLimitsOf(const IntegrationOptions& options, const VoxelGridOptions& grid) {
  const auto truncation = static_cast<float>(grid.truncation_voxels * grid.voxel_size_m);
  const auto margin = static_cast<float>(options.carve_margin_voxels * grid.voxel_size_m);
  return {.frames = static_cast<float>(options.carve_frames),
          .keep = static_cast<float>(options.carve_keep),
          .slope = static_cast<float>(options.carve_slope),
          .max_distance = kCarvedPart * truncation,
          .min_measured = 0.99F * std::min(margin, truncation)};  // 1 % less, for rounding
}

SegmentLabel StrongestLabel(const SurfaceVoxels& voxels, size_t i) {
  LabelVote best;
  for (int slot = 0; slot < kVoteSlots; ++slot) {
    const LabelVote vote = voxels.Vote(static_cast<int>(i), slot);
    if (vote.votes > best.votes) best = vote;
  }
  return best.label;
}

}  // namespace

FrameProjection::FrameProjection(const SegmentedFrame& frame, const Image<float>& depth,
                                 const DepthPyramid& pyramid, Labels labels,
                                 const IntegrationOptions& options, const VoxelGridOptions& grid)
    : frame_(frame),
      depth_(depth),
      labels_(std::move(labels)),
      cut_votes_(options.cut_votes),
      voxel_size_(grid.voxel_size_m),
      carving_(CarvingLimitsOf(options, grid)),
      keep_thin_(options.keep_thin && options.free_space) {
  const Pose T_C_W = frame.frame.header.T_W_C.inverse();
  R_C_W_ = T_C_W.linear();
  t_C_W_ = T_C_W.translation();
  limits_ = LimitsOf(options, grid);
  weights_ = WeightLimitsOf(options);
  if (keep_thin_) {
    thin_hits_ = FindThinHits(frame.frame.header, frame.frame.depth,
                              {.voxel_size = grid.voxel_size_m,
                               .min_range = options.min_range_m,
                               .max_range = options.max_range_m,
                               .noise = options.noise});
  }
  if (options.carve_frames <= 0) return;
  clear_depth_ =
      ClearDepth(pyramid, depth.width(), depth.height(),
                 {.margin = static_cast<float>(options.carve_margin_voxels * grid.voxel_size_m),
                  .sigmas = static_cast<float>(options.carve_sigmas),
                  .noise = options.noise});
}

VoxelBits FrameProjection::CarvePassedVoxels(const ProjectedVoxels& projected,
                                             VoxelSamples& samples, SurfaceVoxels& voxels) const {
  if (clear_depth_.empty() || !MayCarve(samples, limits_.truncation, carving_, voxels)) return {};
  alignas(64) VoxelArray<float> clear;
  LookUpDepth(projected, clear_depth_.data(), clear);
  return CarveVoxels(projected, clear, limits_.truncation, carving_, samples, voxels);
}

void FrameProjection::BlendColors(const VoxelSamples& samples, const VoxelArray<int32_t>& pixel,
                                  const VoxelArray<float>& shares, SurfaceVoxels& voxels) const {
  if (frame_.frame.color.empty()) return;
  const Rgb8* image = frame_.frame.color.data();
  ForEach(VoxelsWith(samples.flags, kTakesColor), [&](size_t i) {
    const Rgb8 seen = image[pixel[i]];
    Rgb8& color = voxels.color[i];
    // Black stands for no colour yet: the voxel was only seen from where it took no colour.
    const float share = color == Rgb8{} ? 1.0F : shares[i];
    color = {Blend(color.r, seen.r, share), Blend(color.g, seen.g, share),
             Blend(color.b, seen.b, share)};
  });
}

int64_t FrameProjection::Vote(const VoxelSamples& samples, const VoxelArray<int32_t>& pixel,
                              SurfaceVoxels& voxels) const {
  int64_t evicted = 0;
  const bool has_kept = HasKeptLabels(voxels);
  SegmentLabel last = SegmentLabel::kNone;
  uint8_t entry = 0;
  ForEach(VoxelsWith(samples.flags, kTakesVote), [&](size_t i) {
    const SegmentIndex segment = frame_.image.index.data()[pixel[i]];
    if (segment == SegmentIndex::kNone) return;  // the pixel is on no segment
    const SegmentLabel label = labels_.of_segment[static_cast<size_t>(Raw(segment))];
    if (label == SegmentLabel::kNone || (has_kept && IsHeldByKept(voxels, i))) return;
    const SegmentLabel cut_from = labels_.cuts.CutFrom(static_cast<size_t>(Raw(segment)));
    if (cut_from != SegmentLabel::kNone) RemoveVotes(cut_from, voxels, i);
    if (label != last) {
      entry = PaletteEntry(voxels, label);
      last = label;
    }
    if (!AddVoteForEntry(voxels, static_cast<int>(i), entry)) ++evicted;
  });
  return evicted;
}

bool FrameProjection::HasKeptLabels(const SurfaceVoxels& voxels) const {
  return labels_.cuts.any_kept() &&
         std::any_of(voxels.palette.begin(), voxels.palette.end(),
                     [this](SegmentLabel label) { return labels_.cuts.IsKept(label); });
}

// Whether a kept label leads at a voxel: it has at least two votes, and no other label has
// more. Where others have more, it may be only the rim of an inexact mask.
bool FrameProjection::IsHeldByKept(const SurfaceVoxels& voxels, size_t voxel) const {
  const auto& votes = voxels.slot_votes[voxel];
  const uint8_t most = std::max<uint8_t>(*std::max_element(votes.begin(), votes.end()), 2);
  for (int slot = 0; slot < kVoteSlots; ++slot) {
    const LabelVote vote = voxels.Vote(static_cast<int>(voxel), slot);
    if (vote.votes >= most && labels_.cuts.IsKept(vote.label)) return true;
  }
  return false;
}

// Takes votes from a label, but leaves it one, so that the voxel does not lose it.
void FrameProjection::RemoveVotes(SegmentLabel label, SurfaceVoxels& voxels, size_t voxel) const {
  for (size_t slot = 0; slot < kVoteSlots; ++slot) {
    const LabelVote vote = voxels.Vote(static_cast<int>(voxel), static_cast<int>(slot));
    if (vote.votes == 0 || labels_.table.Canonical(vote.label) != label) continue;
    voxels.slot_votes[voxel][slot] = static_cast<uint8_t>(std::max(vote.votes - cut_votes_, 1));
  }
}

FrameProjection::Outcome FrameProjection::FuseSurface(const ProjectedVoxels& projected,
                                                      VoxelSamples& samples,
                                                      SurfaceVoxels& voxels) const {
  const VoxelBits said = VoxelsWith(samples.flags, kNearSurface | kSeenFree);
  Outcome outcome{.affected = AffectedBy(said)};
  if (!outcome.changed()) return outcome;  // the frame shows no voxel of this block
  for (const uint64_t word : said) outcome.voxels_updated += std::popcount(word);
  const VoxelBits turning = CarvePassedVoxels(projected, samples, voxels);
  alignas(64) VoxelArray<float> shares;
  FuseDistances(samples, limits_.truncation, weights_, voxels, shares);
  ForEach(turning, [&](size_t i) {
    if (voxels.distance[i] > 0) ++outcome.cleared[StrongestLabel(voxels, i)];
  });
  outcome.cleared.erase(SegmentLabel::kNone);
  BlendColors(samples, projected.pixel, shares, voxels);
  outcome.votes_evicted = Vote(samples, projected.pixel, voxels);
  return outcome;
}

std::span<const ThinHit> FrameProjection::ThinHitsIn(BlockIndex index) const {
  const auto before = [](const ThinHit& hit, BlockIndex block) { return hit.block < block; };
  const auto first = std::lower_bound(thin_hits_.begin(), thin_hits_.end(), index, before);
  auto end = first;
  while (end != thin_hits_.end() && end->block == index) ++end;
  return {first, end};
}

// Counts the thin things of the frame in a block; voxels that the camera clearly sees past lose
// half of their hits. Returns the voxels whose hits changed.
VoxelBits FrameProjection::CountThin(BlockIndex index, Block& block) const {
  const std::span<const ThinHit> hits = ThinHitsIn(index);
  VoxelBits changed{};
  if (!block.thin && hits.empty()) return changed;
  if (!block.thin) block.thin = Shared<ThinVoxels>::Make();
  std::array<uint8_t, kBlockVoxels>& counts = block.thin.Own().hits;
  const auto set = [&](size_t voxel, uint8_t count) {
    if (counts[voxel] != count) changed[voxel / 64] |= uint64_t{1} << (voxel % 64);
    counts[voxel] = count;
  };
  if (!clear_depth_.empty()) {
    ProjectedVoxels projected;
    ProjectVoxels(LatticeOf(index), frame_.frame.header.camera, projected);
    alignas(64) VoxelArray<float> clear;
    LookUpDepth(projected, clear_depth_.data(), clear);
    for (size_t i = 0; i < kBlockVoxels; ++i) {
      if (counts[i] > 0 && projected.z[i] > 0 && clear[i] > projected.z[i])
        set(i, static_cast<uint8_t>(counts[i] / 2));
    }
  }
  for (const ThinHit& hit : hits) {
    const auto voxel = static_cast<size_t>(hit.voxel);
    set(voxel, static_cast<uint8_t>(std::min(counts[voxel] + 1, int{ThinVoxels::kMost})));
  }
  if (*block.thin.get() == ThinVoxels{}) block.thin.reset();
  return changed;
}

FrameProjection::Outcome FrameProjection::Fuse(BlockIndex index, BlockVisibility view,
                                               Block& block) const {
  Outcome outcome = FuseVoxels(index, view, block);
  const bool seen = block.surface || block.free || block.all_free;
  if (keep_thin_ && seen) outcome.affected |= AffectedBy(CountThin(index, block));
  return outcome;
}

VoxelLattice FrameProjection::LatticeOf(BlockIndex index) const {
  const Eigen::Vector3d first_W =
      Eigen::Vector3d(index.x, index.y, index.z) * (kBlockSide * voxel_size_) +
      Eigen::Vector3d::Constant(0.5 * voxel_size_);
  return {(R_C_W_ * first_W + t_C_W_).cast<float>(), (R_C_W_ * voxel_size_).cast<float>()};
}

FrameProjection::Outcome FrameProjection::FuseVoxels(BlockIndex index, BlockVisibility view,
                                                     Block& block) const {
  if (view == BlockVisibility::kWhollyFree && !block.surface) {
    static constexpr VoxelBits kAll{~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull};
    return {.affected = AffectedBy(MarkFree(kAll, block))};
  }
  if (const SurfaceVoxels* there = block.surface.get()) {  // loads while voxels are projected
    PrefetchAll(there->distance);
    PrefetchAll(there->weight);
    PrefetchAll(there->observations);
    PrefetchLine(&there->palette);
  }
  ProjectedVoxels voxels;
  ProjectVoxels(LatticeOf(index), frame_.frame.header.camera, voxels);
  alignas(64) VoxelArray<float> depth;
  LookUpDepth(voxels, depth_.data(), depth);
  VoxelSamples samples;
  JudgeVoxels(voxels, depth, limits_, samples);
  const uint8_t said = UnionOf(samples.flags);
  if (said == 0) return {};  // all voxels are out of view, hidden or out of range
  if (!block.surface && !(said & kNearSurface)) {  // free space only
    return {.affected = AffectedBy(MarkFree(VoxelsWith(samples.flags, kSeenFree), block))};
  }
  if (const SurfaceVoxels* there = block.surface.get()) {
    PrefetchLine(there->palette.data());
    PrefetchAll(there->color);
    PrefetchAll(there->slot_label);
    PrefetchAll(there->slot_votes);
  }
  WeighVoxels(depth, limits_, samples);
  block.surface.Unpack();
  if (block.surface) return FuseSurface(voxels, samples, *block.surface);
  block.surface = Densify(block);
  block.free.reset();
  block.all_free = false;
  Outcome outcome = FuseSurface(voxels, samples, *block.surface);
  outcome.affected = kAllNeighbours;  // voxels seen empty have got other weights than before
  return outcome;
}

}  // namespace vismap
