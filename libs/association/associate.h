#pragma once

#include <string>
#include <utility>
#include <vector>

#include "map/label_table.h"
#include "map/voxel_map.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// The parts of the map that association reads.
struct MapView {
  const VoxelMap& voxels;
  const LabelTable& labels;
};

/// The labels and instances of the map to which the frame's segments belong.
struct FrameAssociation {
  struct Segment {
    SegmentLabel label = SegmentLabel::kNone;  ///< kNone = too few points in range
    InstanceId instance = InstanceId::kNone;   ///< kNone = no detection
    /// The label out of which a mask has cut the segment: more than half of the points lie on
    /// voxels where it is the strongest, but another segment, with another detection or none, got
    /// it. kNone for most segments.
    SegmentLabel cut_from = SegmentLabel::kNone;
  };
  std::vector<Segment> segments;  ///< indexed by SegmentIndex
  /// Pairs (a < b) of alive labels that share a segment of the frame, and known pairs that are on
  /// two segments; both ascending.
  std::vector<std::pair<SegmentLabel, SegmentLabel>> together, apart;
  SegmentLabel next_label{1};   ///< the next free label after this frame
  InstanceId next_instance{1};  ///< the next free instance after this frame
};

struct AssociationOptions {
  /// tau_pi of the paper: a segment gets a label of the map only with more points on it than this.
  int min_overlap_points = 20;
  /// A point counts for the labels of its voxel if |signed distance| there is below this. The
  /// published code's 1 loses labels when poses are off by more than a voxel.
  double max_distance_voxels = 2.0;
  /// Every n-th pixel of every n-th row is looked up; min_overlap_points is divided by n^2.
  int pixel_stride = 2;
  double min_range_m = 0.1;  ///< nearer depth is not looked up, since it is not integrated [m]
  double max_range_m = 5.0;  ///< nor is depth beyond this [m]
  /// Labels with more than this share of a segment's points were seen together.
  double merge_overlap_ratio = 0.2;
};

/// All problems of the options, one sentence each; empty = valid.
std::vector<std::string> Validate(const AssociationOptions& options);

/// Matches the frame's segments to the map's labels, and its detections to the map's instances
/// (Grinvald 2019, Sec. III-C; libs/METHOD.md, Association). Both are matched one to one, the
/// pair with the largest overlap or evidence first; ties go to the lower segment or detection, then
/// to the lower label or instance.
FrameAssociation Associate(const SegmentedFrame& frame, const MapView& map,
                           const AssociationOptions& options);

}  // namespace vismap
