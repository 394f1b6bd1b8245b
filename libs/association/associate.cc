#include "association/associate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "base/parallel.h"
#include "base/require.h"

namespace vismap {
namespace {

// The labels that a voxel votes for, strongest first; kNone pads.
using Choices = std::array<SegmentLabel, kVoteSlots>;
// How many sampled points of each segment fell on voxels with the same choices.
using ChoiceCounts = std::map<std::pair<int, Choices>, int64_t>;

Choices VoxelChoices(const SurfaceVoxels& voxels, int offset, const LabelTable& labels) {
  std::array<std::pair<int, SegmentLabel>, kVoteSlots>
      sums{};  // (-votes, label): sorts strongest first, then lower label
  size_t count = 0;
  for (int slot = 0; slot < kVoteSlots; ++slot) {
    const LabelVote vote = voxels.Vote(offset, slot);
    if (vote.label == SegmentLabel::kNone || vote.votes == 0) continue;
    const SegmentLabel label = labels.Canonical(vote.label);
    size_t i = 0;
    while (i < count && sums[i].second != label) ++i;
    if (i == count) sums[count++] = {0, label};
    sums[i].first -= vote.votes;
  }
  for (size_t i = 1; i < count; ++i) {
    for (size_t j = i; j > 0 && sums[j] < sums[j - 1]; --j) std::swap(sums[j], sums[j - 1]);
  }
  Choices choices{};
  for (size_t i = 0; i < count; ++i) choices[i] = sums[i].second;
  return choices;
}

// Looks up the sampled pixels of the image rows [v_begin, v_end).
class PointLookup {
 public:
  PointLookup(const SegmentedFrame& frame, const MapView& map, const AssociationOptions& options)
      : frame_(frame),
        map_(map),
        options_(options),
        max_distance_(static_cast<float>(options.max_distance_voxels * map.voxels.voxel_size() *
                                         32767.0 / map.voxels.truncation())),
        R_(frame.frame.header.T_W_C.linear()),
        t_(frame.frame.header.T_W_C.translation()) {}

  void CountRows(int v_begin, int v_end, ChoiceCounts& counts, std::vector<int64_t>& points) const {
    const PinholeCamera& camera = frame_.frame.header.camera;
    BlockIndex cached{INT32_MAX, 0, 0};
    const Block* block = nullptr;
    std::pair<int, Choices> last_key{-1, {}};
    int64_t last_count = 0;
    const auto flush = [&] {
      if (last_count > 0) counts[last_key] += last_count;
      last_count = 0;
    };
    for (int v = v_begin; v < v_end; v += options_.pixel_stride) {
      for (int u = 0; u < camera.width; u += options_.pixel_stride) {
        const int segment = Raw(frame_.image.index(v, u));
        const float z = frame_.frame.depth(v, u);
        if (segment < 0 || !(z > options_.min_range && z < options_.max_range)) continue;
        ++points[static_cast<size_t>(segment)];
        const VoxelIndex voxel = map_.voxels.VoxelAt(R_ * camera.BackProject(u, v, z) + t_);
        if (const BlockIndex index = BlockOf(voxel); index != cached) {
          cached = index;
          block = map_.voxels.Find(index);
        }
        if (block == nullptr || !block->surface) continue;
        const int offset = OffsetInBlock(voxel);
        const auto i = static_cast<size_t>(offset);
        if (block->surface->weight[i] == 0 ||
            std::abs(static_cast<float>(block->surface->distance[i])) >= max_distance_) {
          continue;
        }
        std::pair<int, Choices> key{segment, VoxelChoices(*block->surface, offset, map_.labels)};
        if (key.second[0] == SegmentLabel::kNone) continue;
        if (key != last_key) {
          flush();
          last_key = key;
        }
        ++last_count;
      }
    }
    flush();
  }

 private:
  const SegmentedFrame& frame_;
  const MapView& map_;
  const AssociationOptions& options_;
  const float max_distance_;
  const Eigen::Matrix3d R_;
  const Eigen::Vector3d t_;
};

struct FrameCounts {
  ChoiceCounts choices;         // in sampled points
  std::vector<int64_t> points;  // per segment, sampled points in range
};

FrameCounts CountPoints(const SegmentedFrame& frame, const MapView& map,
                        const AssociationOptions& options) {
  const PointLookup lookup(frame, map, options);
  const int rows_per_band =
      16 * options.pixel_stride;  // fixed bands: the sums do not depend on threads anyway
  const int height = frame.image.index.height();
  const auto bands = static_cast<size_t>((height + rows_per_band - 1) / rows_per_band);
  std::vector<FrameCounts> partial(bands);
  ParallelFor(bands, 1, [&](size_t band) {
    partial[band].points.assign(frame.segments.size(), 0);
    const int v_begin = static_cast<int>(band) * rows_per_band;
    lookup.CountRows(v_begin, std::min(height, v_begin + rows_per_band), partial[band].choices,
                     partial[band].points);
  });
  FrameCounts total;
  total.points.assign(frame.segments.size(), 0);
  for (const FrameCounts& part : partial) {
    for (const auto& [key, count] : part.choices) total.choices[key] += count;
    for (size_t s = 0; s < total.points.size(); ++s) total.points[s] += part.points[s];
  }
  return total;
}

// Points per (segment, label) when every voxel votes for its strongest label outside `taken`; the
// paper's Pi.
std::map<std::pair<int, SegmentLabel>, int64_t> Overlaps(const ChoiceCounts& choices,
                                                         const std::map<SegmentLabel, int>& taken) {
  std::map<std::pair<int, SegmentLabel>, int64_t> overlaps;
  for (const auto& [key, count] : choices) {
    for (const SegmentLabel label : key.second) {
      if (label == SegmentLabel::kNone) break;
      const auto owner = taken.find(label);
      if (owner != taken.end() && owner->second != key.first) continue;
      overlaps[{key.first, label}] += count;
      break;
    }
  }
  return overlaps;
}

// One-to-one matching in descending overlap, voxels falling back to their next choice once a label
// is taken.
std::map<SegmentLabel, int> MatchLabels(const ChoiceCounts& choices, int64_t min_count,
                                        size_t segment_count) {
  std::map<SegmentLabel, int> taken;
  std::vector<bool> labelled(segment_count, false);
  for (;;) {
    std::pair<int, SegmentLabel> best{-1, SegmentLabel::kNone};
    int64_t most = min_count;
    for (const auto& [key, count] : Overlaps(choices, taken)) {
      if (labelled[static_cast<size_t>(key.first)] || taken.contains(key.second)) continue;
      if (count > most) {
        most = count;
        best = key;
      }
    }
    if (best.first < 0) return taken;
    taken[best.second] = best.first;
    labelled[static_cast<size_t>(best.first)] = true;
  }
}

// Labels that share a segment of this frame, and known pairs that it shows as different segments.
void FindPairs(const FrameCounts& counts, const std::map<SegmentLabel, int>& taken,
               const MapView& map, const AssociationOptions& options,
               FrameAssociation& association) {
  std::map<int, std::vector<SegmentLabel>> sharing;
  for (const auto& [key, count] : Overlaps(counts.choices, taken)) {
    const auto points = static_cast<double>(counts.points[static_cast<size_t>(key.first)]);
    if (static_cast<double>(count) > options.merge_overlap_ratio * points)
      sharing[key.first].push_back(key.second);
  }
  std::set<std::pair<SegmentLabel, SegmentLabel>> together;
  for (const auto& [segment, labels] : sharing) {
    for (size_t i = 0; i < labels.size(); ++i) {
      for (size_t j = i + 1; j < labels.size(); ++j)
        together.insert(std::minmax(labels[i], labels[j]));
    }
  }
  association.together.assign(together.begin(), together.end());
  for (const auto& [pair, evidence] : map.labels.pairs()) {
    const auto a = taken.find(pair.first), b = taken.find(pair.second);
    if (a == taken.end() || b == taken.end() || together.contains(pair)) continue;
    association.apart.push_back(pair);
  }
}

// Which instance each detection of the frame is: one-to-one, by the summed evidence of its
// segments' labels.
void MatchInstances(const SegmentedFrame& frame, const MapView& map,
                    FrameAssociation& association) {
  std::map<std::pair<int, InstanceId>, double> evidence;
  std::set<int> detections;
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    const FrameSegment& segment = frame.segments[s];
    const SegmentLabel label = association.segments[s].label;
    if (segment.detection == DetectionIndex::kNone || label == SegmentLabel::kNone) continue;
    detections.insert(Raw(segment.detection));
    if (Raw(label) >= Raw(map.labels.next_label())) continue;  // new in this frame
    for (const auto& [instance, amount] : map.labels.Record(label).instance_evidence) {
      evidence[{Raw(segment.detection), instance}] += static_cast<double>(amount) * segment.pixels;
    }
  }
  std::vector<std::tuple<double, int, InstanceId>> ranked;
  for (const auto& [key, amount] : evidence) ranked.emplace_back(-amount, key.first, key.second);
  std::sort(ranked.begin(), ranked.end());
  std::map<int, InstanceId> instance_of;
  std::set<InstanceId> used;
  for (const auto& [amount, detection, instance] : ranked) {
    if (amount >= 0 || instance_of.contains(detection) || used.contains(instance)) continue;
    instance_of[detection] = instance;
    used.insert(instance);
  }
  for (const int detection : detections) {
    if (instance_of.contains(detection)) continue;
    instance_of[detection] = association.next_instance;
    association.next_instance = static_cast<InstanceId>(Raw(association.next_instance) + 1);
  }
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    const FrameSegment& segment = frame.segments[s];
    if (segment.detection == DetectionIndex::kNone ||
        association.segments[s].label == SegmentLabel::kNone)
      continue;
    association.segments[s].instance = instance_of.at(Raw(segment.detection));
  }
}

}  // namespace

std::vector<std::string> Validate(const AssociationOptions& options) {
  std::vector<std::string> problems;
  const auto check = [&](bool ok, const char* text) {
    if (!ok) problems.emplace_back(text);
  };
  check(options.min_overlap_points >= 0, "association: min_overlap_points must be 0 or more");
  check(options.max_distance_voxels > 0, "association: max_distance_voxels must be positive");
  check(options.pixel_stride >= 1 && options.pixel_stride <= 16,
        "association: pixel_stride must be 1..16");
  check(options.merge_overlap_ratio > 0 && options.merge_overlap_ratio <= 1,
        "association: merge_overlap_ratio must be in (0, 1]");
  check(options.min_range >= 0 && options.max_range > options.min_range,
        "association: max_range_m must be above min_range_m, which must be 0 or more");
  return problems;
}

FrameAssociation Associate(const SegmentedFrame& frame, const MapView& map,
                           const AssociationOptions& options) {
  Require(static_cast<int>(frame.segments.size()) == frame.image.segment_count,
          "one record per segment");
  const FrameCounts counts = CountPoints(frame, map, options);
  const int64_t min_count =
      options.min_overlap_points / (options.pixel_stride * options.pixel_stride);
  const std::map<SegmentLabel, int> taken =
      MatchLabels(counts.choices, min_count, frame.segments.size());

  FrameAssociation association;
  association.segments.resize(frame.segments.size());
  association.next_label = map.labels.next_label();
  association.next_instance = map.labels.next_instance();
  for (const auto& [label, segment] : taken)
    association.segments[static_cast<size_t>(segment)].label = label;
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    if (association.segments[s].label != SegmentLabel::kNone || counts.points[s] <= min_count)
      continue;
    association.segments[s].label = association.next_label;
    association.next_label = static_cast<SegmentLabel>(Raw(association.next_label) + 1);
  }
  FindPairs(counts, taken, map, options, association);
  MatchInstances(frame, map, association);
  return association;
}

}  // namespace vismap
