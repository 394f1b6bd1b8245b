#include "support/naive/associate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "map/surface_reader.h"
#include "support/naive/voxel_access.h"
#include "support/voxel_reading.h"

namespace vismap::naive {
namespace {

// The labels that a voxel votes for, strongest first.
using Choices = std::vector<SegmentLabel>;
// How many sampled points of each segment fell on voxels with the same choices.
using ChoiceCounts = std::map<std::pair<int, Choices>, int64_t>;

struct FrameCounts {
  ChoiceCounts choices;         // in sampled points
  std::vector<int64_t> points;  // per segment, sampled points in range
};

// Votes of merged labels are summed; ties go to the lower label.
Choices VoxelChoices(const SurfaceVoxels& voxels, int offset, const LabelTable& labels) {
  std::map<SegmentLabel, int> sums;
  for (const LabelVote& vote : ReadVotes(voxels, offset))
    sums[labels.Canonical(vote.label)] += vote.votes;
  std::vector<std::pair<int, SegmentLabel>> ranked;
  for (const auto& [label, votes] : sums) ranked.emplace_back(-votes, label);
  std::sort(ranked.begin(), ranked.end());
  Choices choices;
  for (const auto& [votes, label] : ranked) choices.push_back(label);
  return choices;
}

// Whether a voxel is so near to a surface that its labels say something of it.
bool IsNear(const StoredVoxel& voxel, const VoxelMap& map, double max_distance_voxels) {
  const auto steps = static_cast<float>(max_distance_voxels * map.voxel_size() * kTruncationSteps /
                                        map.truncation());
  return voxel.weight > 0 && std::abs(static_cast<float>(voxel.distance)) < steps;
}

FrameCounts CountPoints(const SegmentedFrame& frame, const MapView& map,
                        const AssociationOptions& options) {
  const FrameHeader& header = frame.frame.header;
  FrameCounts counts;
  counts.points.assign(frame.segments.size(), 0);
  for (int v = 0; v < header.camera.height; v += options.pixel_stride) {
    for (int u = 0; u < header.camera.width; u += options.pixel_stride) {
      const int segment = Raw(frame.image.index(v, u));
      const float z = frame.frame.depth(v, u);
      if (segment < 0 || !(z > options.min_range_m && z < options.max_range_m)) continue;
      ++counts.points[static_cast<size_t>(segment)];
      const VoxelIndex voxel =
          testing_support::VoxelAt(map.voxels, header.T_W_C * header.camera.BackProject(u, v, z));
      const Block* block = map.voxels.Find(BlockOf(voxel));
      SurfaceReader reader;
      const SurfaceVoxels* voxels = block != nullptr ? reader.Read(*block) : nullptr;
      if (voxels == nullptr) continue;
      const int offset = OffsetInBlock(voxel);
      if (!IsNear(ReadVoxel(*voxels, offset), map.voxels, options.max_distance_voxels)) continue;
      const Choices choices = VoxelChoices(*voxels, offset, map.labels);
      if (!choices.empty()) ++counts.choices[{segment, choices}];
    }
  }
  return counts;
}

// Points per (segment, label) when every voxel votes for its strongest label outside `taken`; the
// paper's Pi.
std::map<std::pair<int, SegmentLabel>, int64_t> Overlaps(const ChoiceCounts& choices,
                                                         const std::map<SegmentLabel, int>& taken) {
  std::map<std::pair<int, SegmentLabel>, int64_t> overlaps;
  for (const auto& [key, count] : choices) {
    for (const SegmentLabel label : key.second) {
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

// Segments of a detection whose points mostly vote for a label that went to another one.
void FindCuts(const SegmentedFrame& frame, const FrameCounts& counts,
              const std::map<SegmentLabel, int>& taken, FrameAssociation& association) {
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    FrameAssociation::Segment& match = association.segments[s];
    if (frame.segments[s].detection == DetectionIndex::kNone || match.label == SegmentLabel::kNone)
      continue;
    for (const auto& [label, other] : taken) {
      int64_t held = 0;
      for (const auto& [key, count] : counts.choices) {
        if (key.first == static_cast<int>(s) && key.second.front() == label) held += count;
      }
      const bool is_another =
          frame.segments[static_cast<size_t>(other)].detection != frame.segments[s].detection;
      if (held > counts.points[s] - held && is_another) match.cut_from = label;
    }
  }
}

// How much the labels of a detection's segments speak for an instance.
double EvidenceFor(InstanceId instance, int detection, const SegmentedFrame& frame,
                   const MapView& map, const FrameAssociation& association) {
  double evidence = 0;
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    const SegmentLabel label = association.segments[s].label;
    if (Raw(frame.segments[s].detection) != detection || label == SegmentLabel::kNone) continue;
    if (Raw(label) >= Raw(map.labels.next_label())) continue;  // new in this frame
    const auto& known = map.labels.Record(label).instance_evidence;
    const auto amount = known.find(instance);
    if (amount != known.end())
      evidence += static_cast<double>(amount->second) * frame.segments[s].pixels;
  }
  return evidence;
}

// Which instance each detection of the frame is: again and again the pair with most evidence of
// those that are left, ties to the lower detection, then to the lower instance.
void MatchInstances(const SegmentedFrame& frame, const MapView& map,
                    FrameAssociation& association) {
  std::set<int> detections;
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    const int detection = Raw(frame.segments[s].detection);
    if (detection >= 0 && association.segments[s].label != SegmentLabel::kNone)
      detections.insert(detection);
  }
  std::set<InstanceId> instances;
  for (const SegmentLabel label : map.labels.Alive()) {
    for (const auto& [instance, amount] : map.labels.Record(label).instance_evidence)
      instances.insert(instance);
  }
  std::map<int, InstanceId> instance_of;
  while (true) {
    double most = 0;
    std::pair<int, InstanceId> best{-1, InstanceId::kNone};
    for (const int detection : detections) {
      if (instance_of.contains(detection)) continue;
      for (const InstanceId instance : instances) {
        const double evidence = EvidenceFor(instance, detection, frame, map, association);
        if (evidence > most) best = {detection, instance};
        most = std::max(most, evidence);
      }
    }
    if (best.first < 0) break;
    instance_of[best.first] = best.second;
    instances.erase(best.second);
  }
  for (const int detection : detections) {
    if (instance_of.contains(detection)) continue;
    instance_of[detection] = association.next_instance;
    association.next_instance = static_cast<InstanceId>(Raw(association.next_instance) + 1);
  }
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    if (association.segments[s].label == SegmentLabel::kNone) continue;
    const auto matched = instance_of.find(Raw(frame.segments[s].detection));
    if (matched != instance_of.end()) association.segments[s].instance = matched->second;
  }
}

}  // namespace

FrameAssociation Associate(const SegmentedFrame& frame, const MapView& map,
                           const AssociationOptions& options) {
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
  FindCuts(frame, counts, taken, association);
  MatchInstances(frame, map, association);
  return association;
}

}  // namespace vismap::naive
