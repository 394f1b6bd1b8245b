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

/// Which persistent segments and instances the frame's segments are.
struct FrameAssociation {
  struct Segment {
    SegmentLabel label = SegmentLabel::kNone;  ///< kNone: too few points in range to say
    InstanceId instance = InstanceId::kNone;
    /// The label that most of the segment's points vote for, though another segment got it, with
    /// another detection or none: a mask has cut this one out of it. kNone mostly.
    SegmentLabel cut_from = SegmentLabel::kNone;
  };
  std::vector<Segment> segments;  ///< indexed by SegmentIndex
  /// Alive labels (a < b) that lay together on one frame segment, and those seen as separate
  /// segments.
  std::vector<std::pair<SegmentLabel, SegmentLabel>> together, apart;
  SegmentLabel next_label{1};  ///< next free ids after this frame
  InstanceId next_instance{1};
};

struct AssociationOptions {
  int min_overlap_points = 20;  ///< tau_pi of the paper: more points than this, or a new label
  /// A point counts for a label if |sdf| at its voxel is below this. The published code's 1 loses
  /// labels when poses are off by more than a voxel.
  double max_distance_voxels = 2.0;
  int pixel_stride = 2;  ///< every n-th pixel each way is looked up; counts are scaled by n^2
  double min_range =
      0.1;  ///< nearer and farther points are not looked up, as they are not integrated [m]
  double max_range = 5.0;
  double merge_overlap_ratio =
      0.2;  ///< a label covering this part of a segment was seen together with its others
};

/// All problems of the options, as sentences; empty = fine.
std::vector<std::string> Validate(const AssociationOptions& options);

/// Matches the frame's segments to the map's labels and its detections to the map's instances
/// (Grinvald 2019, Sec. III-C). One-to-one, greedy by summed evidence; ties to the lower segment,
/// then the lower label.
FrameAssociation Associate(const SegmentedFrame& frame, const MapView& map,
                           const AssociationOptions& options);

}  // namespace vismap
