#include "support/naive/integrate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "geometry/noise_model.h"
#include "support/add_vote.h"
#include "support/naive/smooth_depth.h"
#include "support/naive/voxel_access.h"

namespace vismap::naive {
namespace {

float F(double x) { return static_cast<float>(x); }

/// What a frame says of one voxel.
struct Sample {
  size_t pixel = 0;    // where the voxel falls in the image
  float distance = 0;  // signed, along the ray, at most the truncation [m]
  float weight = 0;    // in steps
  float passed = 0;    // how far space is clear behind the voxel, along z; negative = not [m]
  bool is_near = false, votes = false, colors = false;
};

class View {
 public:
  View(const SegmentedFrame& frame, const IntegrationOptions& options, const VoxelGridOptions& grid)
      : depth_(naive::SmoothDepth(frame.frame.depth, options.noise,
                                  {.radius_px = options.smooth_radius_px})),
        camera_(frame.frame.header.camera),
        T_C_W_(frame.frame.header.T_W_C.inverse()),
        options_(options),
        voxel_size_(grid.voxel_size_m),
        step_C_((T_C_W_.linear() * grid.voxel_size_m).cast<float>()),
        truncation_(F(grid.truncation_voxels * grid.voxel_size_m)),
        carve_margin_(F(options.carve_margin_voxels * grid.voxel_size_m)) {}

  /// The centre of a block's first voxel in the camera [m].
  Eigen::Vector3f FirstVoxel(BlockIndex index) const {
    const Eigen::Vector3d first_W =
        Eigen::Vector3d(index.x, index.y, index.z) * (kBlockSide * voxel_size_) +
        Eigen::Vector3d::Constant(0.5 * voxel_size_);
    return (T_C_W_.linear() * first_W + T_C_W_.translation()).cast<float>();
  }

  /// Of voxel (i, j, k) of the block whose first voxel is at `first_C`; nullopt = nothing.
  std::optional<Sample> Look(const Eigen::Vector3f& first_C, int i, int j, int k) const {
    const auto along = [&](int axis) {
      return first_C[axis] + step_C_(axis, 1) * static_cast<float>(j) +
             step_C_(axis, 2) * static_cast<float>(k) + step_C_(axis, 0) * static_cast<float>(i);
    };
    const float x = along(0), y = along(1), z = along(2);
    if (!(z > 0)) return std::nullopt;
    const float a = x / z, b = y / z;
    const float u = F(camera_.fx) * a + (F(camera_.cx) + 0.5F);
    const float v = F(camera_.fy) * b + (F(camera_.cy) + 0.5F);
    if (!(u >= 0 && v >= 0 && u < F(camera_.width) && v < F(camera_.height))) return std::nullopt;
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    Sample sample;
    sample.pixel =
        static_cast<size_t>(row) * static_cast<size_t>(camera_.width) + static_cast<size_t>(column);
    const float stretch = std::sqrt(a * a + b * b + 1.0F);  // of the ray per metre of depth
    sample.passed = ClearDepth(row, column) - z;
    return Judge(z, depth_(row, column), stretch, sample);
  }

 private:
  std::optional<Sample> Judge(float z, float depth, float stretch, Sample sample) const {
    const float min_range = F(options_.min_range_m);
    if (!(depth >= min_range) || z < min_range) return std::nullopt;
    const float distance = (depth - z) * stretch;
    if (distance < -truncation_) return std::nullopt;  // hidden
    sample.is_near = distance < truncation_;
    if (sample.is_near && depth > F(options_.max_range_m)) return std::nullopt;
    if (!sample.is_near && !(options_.free_space && z <= F(options_.free_space_range_m)))
      return std::nullopt;
    sample.distance = std::min(distance, truncation_);
    sample.weight = Weight(depth, distance);
    const auto within = [&](double metres) {
      return sample.is_near && std::abs(distance) <= F(metres);
    };
    sample.votes = within(options_.vote_distance_voxels * voxel_size_);
    sample.colors = within(2 * voxel_size_);
    return sample;
  }

  /// The least depth in the tile of 4x4 pixels and those around, less the margin; 0 when a pixel of
  /// the tile, or all of one around, have none.
  float ClearDepth(int row, int column) const {
    const int v0 = row / 4 * 4, u0 = column / 4 * 4;
    float nearest = std::numeric_limits<float>::infinity();
    for (int v = v0 - 4; v < v0 + 8; v += 4) {
      for (int u = u0 - 4; u < u0 + 8; u += 4) {
        if (v < 0 || u < 0 || v >= depth_.height() || u >= depth_.width()) continue;
        int known = 0, all = 0;
        for (int y = v; y < std::min(v + 4, depth_.height()); ++y) {
          for (int x = u; x < std::min(u + 4, depth_.width()); ++x) {
            ++all;
            if (!(depth_(y, x) > 0)) continue;
            ++known;
            nearest = std::min(nearest, depth_(y, x));
          }
        }
        const bool own = v == v0 && u == u0;
        if (known == 0 || (own && known < all)) return 0;
      }
    }
    const float sigma = F(options_.noise.AxialSigma(static_cast<double>(nearest)));
    return std::max(nearest - std::max(carve_margin_, F(options_.carve_sigmas) * sigma), 0.0F);
  }

  /// 1 at 1 m, less with the square of the depth, fading out behind the surface; at least a step.
  float Weight(float depth, float distance) const {
    const float inverse = 1.0F / std::max(depth, 0.5F);
    const float fade_scale = 1.0F / (truncation_ + -F(voxel_size_));
    const float fading = std::min((truncation_ + distance) * fade_scale, 1.0F);
    return std::max(inverse * inverse * fading * kWeightScale, 1.0F);
  }

  const Image<float> depth_;
  const PinholeCamera& camera_;
  const Pose T_C_W_;
  const IntegrationOptions& options_;
  const double voxel_size_;
  const Eigen::Matrix3f step_C_;  // columns: one voxel along x, y, z of W [m]
  const float truncation_;
  const float carve_margin_;
};

uint8_t Blend(uint8_t old_value, uint8_t new_value, float share) {
  const auto a = static_cast<float>(old_value), b = static_cast<float>(new_value);
  return static_cast<uint8_t>(a + share * (b - a) + 0.5F);
}

/// A voxel that is clearly passed loses weight; with much of it, it takes nothing else from the
/// frame.
void CarveVoxel(const IntegrationOptions& options, float truncation, StoredVoxel* voxel,
                Sample* sample) {
  const float distance = static_cast<float>(voxel->distance) * (truncation / kTruncationSteps);
  const bool passed = options.carve_frames > 0 && voxel->weight > 0 &&
                      distance < 0.75F * truncation &&
                      sample->passed > F(options.carve_slope) * std::max(distance, 0.0F);
  if (!passed) return;
  const float weight = voxel->weight, least = F(options.carve_frames) * sample->weight;
  const bool heavy = weight > least + 2.0F * sample->weight;
  const float left =
      heavy ? std::max(weight * F(options.carve_keep), least) : std::min(weight, least);
  voxel->weight = static_cast<uint16_t>(left + 0.5F);
  if (heavy) sample->weight = 0;
}

/// The label with the most votes, in the first slot of those; kNone = no vote.
SegmentLabel StrongestLabel(const SurfaceVoxels& voxels, int offset) {
  LabelVote best;
  for (const LabelVote& vote : ReadVotes(voxels, offset)) {
    if (vote.votes > best.votes) best = vote;
  }
  return best.label;
}

/// A mean distance of nine tenths of the truncation or more is one of free space.
constexpr float kFreeSteps = 9 * kTruncationSteps / 10;

/// The running means of distance and colour, and the counts.
StoredVoxel FuseVoxel(StoredVoxel voxel, const Sample& sample, const Image<Rgb8>& colors,
                      const IntegrationOptions& options, float truncation) {
  const float old_weight = voxel.weight, old_distance = voxel.distance;
  const float sum = old_weight + sample.weight, share = sample.weight / std::max(sum, 1.0F);
  const float fused =
      old_distance + share * (sample.distance * (kTruncationSteps / truncation) - old_distance);
  voxel.distance = static_cast<int16_t>(static_cast<int>(fused + 32768.5F) - 32768);
  float weight = std::min(sum, F(options.max_weight) * kWeightScale);
  if (options.free_frames > 0 && sample.weight > 0 && fused >= kFreeSteps)
    weight = std::min(weight, std::max(F(options.free_frames), 1.0F) * sample.weight);
  voxel.weight = static_cast<uint16_t>(weight + 0.5F);
  if (sample.weight > 0)
    voxel.observations = static_cast<uint8_t>(std::min(voxel.observations + 1, 255));
  if (sample.colors && !colors.empty()) {
    const Rgb8 seen = colors.data()[sample.pixel];
    const float part = voxel.color == Rgb8{} ? 1.0F : share;  // it has no colour yet
    voxel.color = {Blend(voxel.color.r, seen.r, part), Blend(voxel.color.g, seen.g, part),
                   Blend(voxel.color.b, seen.b, part)};
  }
  return voxel;
}

/// What the frame's segment at a pixel is in the map; without label where there is no segment.
FrameAssociation::Segment SegmentAt(const SegmentedFrame& frame,
                                    const FrameAssociation& association, size_t pixel) {
  const SegmentIndex segment = frame.image.index.data()[pixel];
  if (segment == SegmentIndex::kNone) return {};
  return association.segments[static_cast<size_t>(Raw(segment))];
}

/// The evidence that masks gave a label, and whether it is enough to stand against other votes.
bool IsMasked(SegmentLabel label, const LabelTable& labels, const IntegrationOptions& options) {
  const auto next = Raw(labels.next_label());
  if (options.mask_evidence <= 0 || label == SegmentLabel::kNone || Raw(label) >= next)
    return false;
  const LabelRecord& record = labels.Record(labels.Canonical(label));
  double evidence = 0;
  for (const auto& [class_id, amount] : record.class_evidence)
    evidence += static_cast<double>(amount);
  return evidence > options.mask_evidence && 4 * evidence >= record.frames_with_detector;
}

bool IsShown(SegmentLabel label, const FrameAssociation& association) {
  return std::ranges::any_of(association.segments,
                             [&](const auto& segment) { return segment.label == label; });
}

/// The vote of a frame's segment on one voxel; false = it, or another one, was lost.
bool VoteOn(SurfaceVoxels& voxels, int offset, const FrameAssociation::Segment& segment,
            const FrameAssociation& association, const LabelTable& labels,
            const IntegrationOptions& options) {
  if (segment.label == SegmentLabel::kNone) return true;
  int most = 2;
  for (const LabelVote& vote : ReadVotes(voxels, offset)) most = std::max<int>(most, vote.votes);
  for (const LabelVote& vote : ReadVotes(voxels, offset)) {
    const SegmentLabel label = labels.Canonical(vote.label);
    if (vote.votes == most && IsMasked(label, labels, options) && !IsShown(label, association))
      return true;
  }
  if (segment.cut_from != SegmentLabel::kNone && IsMasked(segment.label, labels, options)) {
    for (uint8_t& votes : voxels.slot_votes[static_cast<size_t>(offset)]) {
      const auto slot = &votes - voxels.slot_votes[static_cast<size_t>(offset)].data();
      const SegmentLabel label = voxels.Vote(offset, static_cast<int>(slot)).label;
      if (votes > 0 && labels.Canonical(label) == segment.cut_from)
        votes = static_cast<uint8_t>(std::max(votes - options.cut_votes, 1));
    }
  }
  return testing_support::AddVote(voxels, offset, segment.label);
}

template <typename Visit>
void ForVoxels(const Visit& visit) {
  for (int k = 0; k < kBlockSide; ++k) {
    for (int j = 0; j < kBlockSide; ++j) {
      for (int i = 0; i < kBlockSide; ++i) visit(i, j, k);
    }
  }
}

/// Fuses what the frame says of one block into it; true when that changed it.
bool FuseBlock(const SegmentedFrame& frame, const FrameAssociation& association,
               const std::vector<std::optional<Sample>>& samples, const IntegrationOptions& options,
               float truncation, const LabelTable& labels, Block& block, MapDelta* delta) {
  bool changed = false;
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    std::optional<Sample> sample = samples[static_cast<size_t>(offset)];
    if (!sample) continue;
    block.surface.Unpack();
    if (!block.surface) {
      changed = SeeFree(block, offset) || changed;
      continue;
    }
    SurfaceVoxels& voxels = *block.surface;
    StoredVoxel voxel = ReadVoxel(voxels, offset);
    const bool was_inside = voxel.weight > 0 && voxel.distance <= 0;
    const bool may_turn = was_inside && sample->passed > 0 && options.carve_frames > 0;
    CarveVoxel(options, truncation, &voxel, &*sample);
    WriteVoxel(voxels, offset, FuseVoxel(voxel, *sample, frame.frame.color, options, truncation));
    const SegmentLabel was = StrongestLabel(voxels, offset);
    if (may_turn && voxels.distance[static_cast<size_t>(offset)] > 0 && was != SegmentLabel::kNone)
      ++delta->cleared[was];
    if (sample->votes && !VoteOn(voxels, offset, SegmentAt(frame, association, sample->pixel),
                                 association, labels, options))
      ++delta->votes_evicted;
    ++delta->voxels_updated;
    changed = true;
  }
  if (!block.surface) DropFullBits(block);
  return changed;
}

/// What the frame says of each voxel of a block, by offset.
std::vector<std::optional<Sample>> LookAtBlock(const View& view, BlockIndex index) {
  std::vector<std::optional<Sample>> samples(kBlockVoxels);
  const Eigen::Vector3f first_C = view.FirstVoxel(index);
  ForVoxels([&](int i, int j, int k) {
    samples[static_cast<size_t>(LinearIndex(i, j, k))] = view.Look(first_C, i, j, k);
  });
  return samples;
}

BlockSaid Count(const std::vector<std::optional<Sample>>& samples) {
  BlockSaid said;
  for (const std::optional<Sample>& sample : samples) {
    if (sample) ++(sample->is_near ? said.near : said.free);
  }
  return said;
}

/// What IntegrateFrame does to the labels has no fast path: the same code does it here, on the
/// frame without its depth, which changes no voxel.
MapDelta UpdateLabels(const SegmentedFrame& frame, const FrameAssociation& association,
                      const IntegrationOptions& options, SemanticMap* map) {
  SegmentedFrame blind = frame;
  std::ranges::fill(blind.frame.depth.pixels(), std::numeric_limits<float>::quiet_NaN());
  return vismap::IntegrateFrame(blind, association, options, map);
}

}  // namespace

std::vector<BlockIndex> BlocksInView(const FrameHeader& header, const IntegrationOptions& options,
                                     const VoxelMap& voxels) {
  const double range =
      std::max(options.max_range_m, options.free_space_range_m) + voxels.truncation();
  const PinholeCamera& camera = header.camera;
  Eigen::AlignedBox3d box(header.T_W_C.translation());
  for (const double u : {-0.5, camera.width - 0.5}) {
    for (const double v : {-0.5, camera.height - 0.5})
      box.extend(header.T_W_C * camera.BackProject(u, v, range));
  }
  const Eigen::Vector3i low = (box.min() / voxels.block_size()).array().floor().cast<int>();
  const Eigen::Vector3i high = (box.max() / voxels.block_size()).array().floor().cast<int>();
  std::vector<BlockIndex> blocks;
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) blocks.push_back({x, y, z});
    }
  }
  return blocks;
}

BlockSaid WhatIsSaid(const SegmentedFrame& frame, const IntegrationOptions& options,
                     const VoxelGridOptions& grid, BlockIndex index) {
  return Count(LookAtBlock(View(frame, options, grid), index));
}

MapDelta IntegrateFrame(const SegmentedFrame& frame, const FrameAssociation& association,
                        const IntegrationOptions& options, SemanticMap* map) {
  const View view(frame, options, map->voxels.options());
  const auto truncation = F(map->voxels.truncation());
  MapDelta delta;
  for (const BlockIndex index : BlocksInView(frame.frame.header, options, map->voxels)) {
    const std::vector<std::optional<Sample>> samples = LookAtBlock(view, index);
    const BlockSaid said = Count(samples);
    if (said.near + said.free == 0) continue;
    Block& block = map->voxels.FindOrCreate(index);
    if (said.near > 0 && !block.surface) MakeSurface(block);
    if (FuseBlock(frame, association, samples, options, truncation, map->labels, block, &delta))
      delta.changed_blocks.push_back(index);
  }
  const MapDelta labels = UpdateLabels(frame, association, options, map);
  for (const auto& [label, count] : delta.cleared) {
    LabelRecord& record = map->labels.MutableRecord(map->labels.Canonical(label));
    record.cleared_voxels += count;
    record.cleared_utime = std::max(record.cleared_utime, frame.frame.header.utime);
  }
  delta.revision = labels.revision;
  delta.merged = labels.merged;
  return delta;
}

}  // namespace vismap::naive
