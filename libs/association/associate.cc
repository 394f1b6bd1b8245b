#include "association/associate.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "association/label_matching.h"
#include "association/point_counts.h"
#include "base/option_check.h"
#include "base/require.h"

namespace vismap {
namespace {

// Finds pairs of labels that share a segment of this frame, and known pairs that are on different
// segments.
void FindPairs(const FrameCounts& counts, const LabelMatching& matching, const MapView& map,
               const AssociationOptions& options, FrameAssociation& association) {
  std::map<int, std::vector<SegmentLabel>> sharing;
  for (const LabelOverlap& overlap : matching.overlaps) {
    const auto points = static_cast<double>(counts.points[static_cast<size_t>(overlap.segment)]);
    if (static_cast<double>(overlap.points) > options.merge_overlap_ratio * points)
      sharing[overlap.segment].push_back(overlap.label);
  }
  std::set<std::pair<SegmentLabel, SegmentLabel>> together;
  for (const auto& [segment, labels] : sharing) {
    for (size_t i = 0; i < labels.size(); ++i) {
      for (size_t j = i + 1; j < labels.size(); ++j)
        together.insert(std::minmax(labels[i], labels[j]));
    }
  }
  association.together.assign(together.begin(), together.end());
  // The map may know many more pairs than those of the labels in this frame.
  const auto& pairs = map.labels.pairs();
  for (const auto& [label, segment] : matching.segment_of) {
    for (auto known = pairs.lower_bound({label, SegmentLabel::kNone});
         known != pairs.end() && known->first.first == label; ++known) {
      if (matching.segment_of.contains(known->first.second) && !together.contains(known->first))
        association.apart.push_back(known->first);
    }
  }
}

// Matches the detections of the frame to instances, one to one, by the evidence of the labels of
// their segments. Detections that are left get new instances.
void MatchInstances(const SegmentedFrame& frame, const MapView& map,
                    FrameAssociation& association) {
  std::map<std::pair<int, InstanceId>, double> evidence;
  std::set<int> detections;
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    const FrameSegment& segment = frame.segments[s];
    const SegmentLabel label = association.segments[s].label;
    if (segment.detection == DetectionIndex::kNone || label == SegmentLabel::kNone) continue;
    detections.insert(Raw(segment.detection));
    if (Raw(label) >= Raw(map.labels.next_label())) continue;  // new, so without evidence
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
    // Without evidence, or one of the two is matched already.
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

// Finds the segments that a mask has cut out of the label of another segment.
void FindCuts(const SegmentedFrame& frame, const FrameCounts& counts, const LabelMatching& matching,
              FrameAssociation& association) {
  std::map<std::pair<int32_t, SegmentLabel>, int64_t> held;  // points by strongest label of a voxel
  for (const ChoiceCount& count : counts.choices) {
    const DetectionIndex detection = frame.segments[static_cast<size_t>(count.segment)].detection;
    if (detection != DetectionIndex::kNone) held[{count.segment, count.choices[0]}] += count.points;
  }
  for (const auto& [key, points] : held) {
    const auto segment = static_cast<size_t>(key.first);
    const auto owner = matching.segment_of.find(key.second);
    // No segment got the label, it is on half of the points at most, or the segment has no label.
    if (owner == matching.segment_of.end() || 2 * points <= counts.points[segment] ||
        association.segments[segment].label == SegmentLabel::kNone)
      continue;
    const FrameSegment& other = frame.segments[static_cast<size_t>(owner->second)];
    if (other.detection != frame.segments[segment].detection)
      association.segments[segment].cut_from = key.second;
  }
}

}  // namespace

std::vector<std::string> Validate(const AssociationOptions& options) {
  OptionCheck check;
  VISMAP_CHECK_AT_LEAST(check, options.min_overlap_points, 0);
  check.Unless(options.max_distance_voxels > 0, "max_distance_voxels must be above 0");
  VISMAP_CHECK_RANGE(check, options.pixel_stride, 1, 16);
  check.Unless(options.merge_overlap_ratio > 0 && options.merge_overlap_ratio <= 1,
               "merge_overlap_ratio must be above 0 and at most 1");
  check.Unless(options.min_range_m >= 0 && options.max_range_m > options.min_range_m,
               "max_range_m must be above min_range_m, which must be at least 0");
  return std::move(check).problems();
}

FrameAssociation Associate(const SegmentedFrame& frame, const MapView& map,
                           const AssociationOptions& options) {
  Require(static_cast<int>(frame.segments.size()) == frame.image.segment_count,
          "one record per segment");
  const FrameCounts counts = CountPoints(frame, map, options);
  const int64_t min_count =
      options.min_overlap_points / (options.pixel_stride * options.pixel_stride);
  const LabelMatching matching = MatchLabels(counts, min_count);

  FrameAssociation association;
  association.segments.resize(frame.segments.size());
  association.next_label = map.labels.next_label();
  association.next_instance = map.labels.next_instance();
  for (const auto& [label, segment] : matching.segment_of)
    association.segments[static_cast<size_t>(segment)].label = label;
  for (size_t s = 0; s < frame.segments.size(); ++s) {
    if (association.segments[s].label != SegmentLabel::kNone || counts.points[s] <= min_count)
      continue;
    association.segments[s].label = association.next_label;
    association.next_label = static_cast<SegmentLabel>(Raw(association.next_label) + 1);
  }
  FindPairs(counts, matching, map, options, association);
  FindCuts(frame, counts, matching, association);
  MatchInstances(frame, map, association);
  return association;
}

}  // namespace vismap
