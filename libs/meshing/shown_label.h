#pragma once

#include <vector>

#include "map/label_table.h"

namespace vismap {

/// The ids that surface with a label shows in a mesh.
struct ShownLabel {
  SegmentLabel segment = SegmentLabel::kNone;  ///< alive label
  InstanceId instance = InstanceId::kNone;
  ClassId class_id = ClassId::kUnknown;
  friend bool operator==(const ShownLabel&, const ShownLabel&) = default;
};

/// What each label shows before instances are read out: the segment alone, of a merged label that
/// of its survivor. Indexed by label, merged labels included.
std::vector<ShownLabel> ShowSegments(const LabelTable& table);

}  // namespace vismap
