#include "mapping/integrate.h"

#include <algorithm>

#include "base/option_check.h"
#include "base/parallel.h"
#include "base/require.h"
#include "geometry/smooth_depth.h"
#include "mapping/fuse_block.h"
#include "mapping/mask_cuts.h"
#include "mapping/visible_blocks.h"

namespace vismap {
namespace {

// A block is packed only after this many frames without a change to it.
constexpr uint32_t kPackAfter = 5;
constexpr size_t kBytesPerMegabyte = size_t{1} << 20;
// Each pair of labels under masks takes time and memory, so a frame with very many would stop the
// mapping.
constexpr size_t kMostMaskedLabels = 1000;

// Adds the frame to the counts F, Phi and Psi of the paper (Sec. III-D). Phi and Psi grow by the
// detection's score times the overlap of mask and segment.
void CountEvidence(const SegmentedFrame& frame, const FrameAssociation& association,
                   LabelTable& labels) {
  labels.GrowLabels(association.next_label);
  labels.GrowInstances(association.next_instance);
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    const FrameAssociation::Segment& match = association.segments[s];
    if (match.label == SegmentLabel::kNone) continue;  // too few points in range
    const FrameSegment& segment = frame.segments[s];
    LabelRecord& record = labels.MutableRecord(match.label);
    const int64_t utime = frame.frame.header.utime;
    record.first_utime = record.frames == 0 ? utime : std::min(record.first_utime, utime);
    record.last_utime = record.frames == 0 ? utime : std::max(record.last_utime, utime);
    ++record.frames;
    record.cleared_voxels = 0;  // the frame shows that the object is still there
    record.cleared_utime = 0;
    if (frame.had_detections) ++record.frames_with_detector;
    record.pixels += static_cast<uint64_t>(segment.pixels);
    if (match.instance == InstanceId::kNone) continue;  // no detection
    const float evidence = segment.score * segment.overlap;
    record.instance_evidence[match.instance] += evidence;
    record.class_evidence[segment.class_id] += evidence;
  }
}

// The labels under the masks of the frame.
std::vector<MaskedLabel> FindMaskedLabels(const SegmentedFrame& frame,
                                          const FrameAssociation& association) {
  std::vector<MaskedLabel> seen;
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    const FrameAssociation::Segment& match = association.segments[s];
    if (match.label == SegmentLabel::kNone || match.instance == InstanceId::kNone) continue;
    const FrameSegment& segment = frame.segments[s];
    seen.push_back({match.label, segment.detection, segment.score * segment.overlap});
  }
  return seen;
}

struct WorkItem {
  VisibleBlock target;
  Block* block = nullptr;  // in the map; nullptr = not there yet, then `fresh` is used
  Block fresh;
  FrameProjection::Outcome outcome;
  size_t bytes_before = 0, bytes_after = 0;  // of the block
};

std::vector<WorkItem> LookUp(const std::vector<VisibleBlock>& visible, VoxelMap& voxels) {
  std::vector<WorkItem> work(visible.size());
  for (size_t i = 0; i < visible.size(); ++i) {
    work[i].target = visible[i];
    work[i].block = voxels.FindMutable(visible[i].index);
  }
  return work;
}

// The memory that new blocks may take, at most.
size_t LargestGrowth(const std::vector<WorkItem>& work) {
  size_t bytes = 0;
  for (const WorkItem& item : work) {
    if (item.block != nullptr) continue;
    bytes += sizeof(Block) + (item.target.view == BlockVisibility::kMixed ? sizeof(SurfaceVoxels)
                                                                          : sizeof(FreeVoxels));
  }
  return bytes;
}

// Leaves out new blocks when the map might grow beyond `most` bytes.
void LimitGrowth(size_t bytes, size_t most, std::vector<WorkItem>* work, MapDelta* delta) {
  if (bytes + LargestGrowth(*work) <= most) return;
  delta->blocks_left_out = static_cast<int64_t>(
      std::erase_if(*work, [](const WorkItem& item) { return item.block == nullptr; }));
  const bool shows_known_surface =
      std::any_of(work->begin(), work->end(), [](const WorkItem& item) {
        return item.target.view == BlockVisibility::kMixed && item.block->surface;
      });
  const std::string reached = "the map has reached its limit of " +
                              std::to_string(most / kBytesPerMegabyte) +
                              " MB (integration.max_map_mb)";
  if (!shows_known_surface) delta->refused = reached + ", and the frame shows no surface of it";
  // Labels and poses take memory, too, also in frames that bring no block.
  if (bytes > most + most / 8) delta->refused = reached + " by more than an eighth";
}

// The blocks that the frame may change, within the limits of the options.
std::vector<WorkItem> FindWork(const FrameHeader& header, const DepthPyramid& pyramid,
                               const IntegrationOptions& options, SemanticMap* map,
                               MapDelta* delta) {
  VisibilityOptions visibility{map->voxels.block_size(),   map->voxels.truncation(),
                               options.min_range_m,        options.max_range_m,
                               options.free_space_range_m, options.free_space};
  visibility.max_cost = static_cast<size_t>(options.max_frame_blocks) * kCostPerBlock;
  const auto may_change = [&](const VisibleBlock& target) {
    if (target.view == BlockVisibility::kMixed) return true;
    // The whole block was seen empty: nothing new for a block that is free everywhere already,
    // unless something thin was there.
    const Block* block = map->voxels.Find(target.index);
    return block == nullptr || !block->all_free || block->thin;
  };
  const std::vector<VisibleBlock> visible =
      FindVisibleBlocks(header, pyramid, visibility, may_change);
  if (FrameCost(visible) > visibility.max_cost) {
    delta->refused = "the frame would change more than " +
                     std::to_string(options.max_frame_blocks) +
                     " blocks of the map (integration.max_frame_blocks)";
    return {};
  }
  std::vector<WorkItem> work = LookUp(visible, map->voxels);
  LimitGrowth(BytesOf(*map), MaxMapBytes(options), &work, delta);
  return work;
}

// Blocks were looked up before, and are inserted after the parallel part, since the table must not
// change while threads use it.
void FuseBlocks(const FrameProjection& projection, std::vector<WorkItem> work, uint32_t revision,
                VoxelMap& voxels, MapDelta& delta) {
  ParallelFor(work.size(), 32, [&](size_t i) {
    WorkItem& item = work[i];
    Block& block = item.block != nullptr ? *item.block : item.fresh;
    item.bytes_before = BytesOf(block);
    item.outcome = projection.Fuse(item.target.index, item.target.view, block);
    item.bytes_after = BytesOf(block);
  });
  for (WorkItem& item : work) {
    if (item.block != nullptr || item.outcome.changed())
      voxels.CountBytes(item.bytes_before, item.bytes_after);
    if (!item.outcome.changed()) continue;
    if (item.block == nullptr) {
      item.block = &voxels.FindOrCreate(item.target.index);
      *item.block = std::move(item.fresh);
    }
    if (item.block->surface) voxels.MarkUsed(item.target.index, *item.block, revision);
    delta.changed_blocks.push_back(item.target.index);
    delta.affected.push_back(item.outcome.affected);
    delta.voxels_updated += item.outcome.voxels_updated;
    delta.votes_evicted += item.outcome.votes_evicted;
    for (const auto& [label, count] : item.outcome.cleared) delta.cleared[label] += count;
  }
}

void AddCleared(const MapDelta& delta, int64_t utime, LabelTable& labels) {
  for (const auto& [label, count] : delta.cleared) {
    LabelRecord& record = labels.MutableRecord(labels.Canonical(label));
    record.cleared_voxels += count;
    record.cleared_utime = std::max(record.cleared_utime, utime);
  }
}

bool BelongToDifferentObjects(SegmentLabel a, SegmentLabel b, const LabelTable& labels) {
  const InstanceId x = labels.Read(a).instance, y = labels.Read(b).instance;
  return x != y && x != InstanceId::kNone && y != InstanceId::kNone;
}

// Merges labels that were on one segment in enough more frames than on two: they are one piece of
// surface. Pairs with a kept label are not counted: without a mask, depth shows both as one
// segment in every frame.
void MergeLabels(const FrameAssociation& association, const MaskCuts& cuts, double merge_frames,
                 LabelTable& labels, MapDelta& delta) {
  if (merge_frames <= 0) return;  // merging is off
  std::vector<std::pair<SegmentLabel, SegmentLabel>> together = association.together;
  std::erase_if(together, [&](const auto& pair) {
    return cuts.IsKept(pair.first) || cuts.IsKept(pair.second);
  });
  for (const auto& [a, b] : together) labels.MutablePair(a, b).together += 1;
  for (const auto& [a, b] : association.apart) labels.MutablePair(a, b).apart += 1;
  for (const auto& pair : together) {
    const SegmentLabel a = labels.Canonical(pair.first), b = labels.Canonical(pair.second);
    if (a == b) continue;  // an earlier pair has merged them
    const PairEvidence& evidence = labels.MutablePair(a, b);
    if (evidence.together - evidence.apart < merge_frames || BelongToDifferentObjects(a, b, labels))
      continue;
    const SegmentLabel survivor = labels.Merge(a, b);
    delta.merged.emplace_back(survivor == a ? b : a, survivor);
  }
}

}  // namespace

std::vector<std::string> Validate(const IntegrationOptions& options) {
  OptionCheck check;
  check.Unless(options.min_range_m > 0, "min_range_m must be above 0");
  check.Unless(options.max_range_m > options.min_range_m, "max_range_m must be above min_range_m");
  VISMAP_CHECK_AT_LEAST(check, options.free_space_range_m, 0);
  VISMAP_CHECK_RANGE(check, options.max_weight, 1, 511);
  check.Unless(options.vote_distance_voxels > 0, "vote_distance_voxels must be above 0");
  VISMAP_CHECK_AT_LEAST(check, options.max_unpacked_blocks, 0);
  VISMAP_CHECK_AT_LEAST(check, options.merge_frames, 0);
  check.Unless(options.split_frames >= 0 && options.split_frames < MaskBonds::kMost,
               "split_frames must be at least 0 and below 5");
  VISMAP_CHECK_AT_LEAST(check, options.mask_evidence, 0);
  VISMAP_CHECK_RANGE(check, options.cut_votes, 0, 255);
  VISMAP_CHECK_RANGE(check, options.carve_frames, 0, 100);
  VISMAP_CHECK_RANGE(check, options.free_frames, 0, 10000);
  check.Unless(options.carve_keep > 0 && options.carve_keep < 1,
               "carve_keep must be above 0 and below 1");
  VISMAP_CHECK_RANGE(check, options.carve_margin_voxels, 2, 1000);
  VISMAP_CHECK_RANGE(check, options.carve_sigmas, 0, 100);
  VISMAP_CHECK_RANGE(check, options.carve_slope, 0, 1000);
  VISMAP_CHECK_RANGE(check, options.smooth_radius_px, 0, kMostSmoothRadius);
  VISMAP_CHECK_RANGE(check, options.max_map_mb, 1, 1048576);
  VISMAP_CHECK_RANGE(check, options.max_frame_blocks, 1000, 100000000);
  return std::move(check).problems();
}

MapDelta IntegrateFrame(const SegmentedFrame& frame, const FrameAssociation& association,
                        const IntegrationOptions& options, SemanticMap* map) {
  const FrameHeader& header = frame.frame.header;
  Require(association.segments.size() == frame.segments.size(), "one association per segment");
  Require(frame.frame.depth.width() == header.camera.width &&
              frame.frame.depth.height() == header.camera.height &&
              frame.image.index.width() == header.camera.width &&
              frame.image.index.height() == header.camera.height,
          "depth and segment images have the size of the camera");
  MapDelta delta;
  delta.revision = map->revision;
  const Image<float> depth =
      SmoothDepth(frame.frame.depth, options.noise, {.radius_px = options.smooth_radius_px});
  const DepthPyramid pyramid(depth);
  const std::vector<MaskedLabel> masked = FindMaskedLabels(frame, association);
  if (masked.size() > kMostMaskedLabels) {
    delta.refused = "the frame has " + std::to_string(masked.size()) +
                    " segments under masks; at most " + std::to_string(kMostMaskedLabels) +
                    " can be mapped";
    return delta;
  }
  std::vector<WorkItem> work = FindWork(header, pyramid, options, map, &delta);
  if (!delta.refused.empty()) return delta;

  const MaskCuts cuts(association, map->labels, options.mask_evidence);
  CountEvidence(frame, association, map->labels);
  // Splits instances of which the masks of this frame show two objects.
  delta.split = SplitInstances(masked, options.split_frames, &map->labels);

  std::vector<SegmentLabel> labels;
  for (const FrameAssociation::Segment& segment : association.segments)
    labels.push_back(segment.label);
  const FrameProjection projection(frame, depth, pyramid, {std::move(labels), cuts, map->labels},
                                   options, map->voxels.options());
  const auto revision = static_cast<uint32_t>(map->revision + 1);
  FuseBlocks(projection, std::move(work), revision, map->voxels, delta);
  if (revision > kPackAfter)
    map->voxels.PackUnused(revision - kPackAfter, static_cast<size_t>(options.max_unpacked_blocks));
  AddCleared(delta, header.utime, map->labels);
  MergeLabels(association, cuts, options.merge_frames, map->labels, delta);

  map->last_utime = std::max(map->last_utime, header.utime);
  map->last_camera_W = header.T_W_C.translation();
  delta.revision = ++map->revision;
  return delta;
}

}  // namespace vismap
