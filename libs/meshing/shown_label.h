#pragma once

#include <vector>

#include "map/label_table.h"

namespace vismap {

/// What a voxel with a label shows.
struct ShownLabel {
  SegmentLabel segment = SegmentLabel::kNone;  ///< canonical
  InstanceId instance = InstanceId::kNone;
  ClassId class_id = ClassId::kUnknown;
  friend bool operator==(const ShownLabel&, const ShownLabel&) = default;
};

/// What every label shows before instances are read out: its canonical segment alone. Indexed by
/// label, merged labels included.
std::vector<ShownLabel> ShowSegments(const LabelTable& table);

}  // namespace vismap
