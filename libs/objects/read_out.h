#pragma once

#include <map>
#include <span>
#include <vector>

#include "map/label_table.h"
#include "meshing/mesh.h"
#include "meshing/shown_label.h"

namespace vismap {

/// What an instance is, as far as the map knows.
struct InstanceReading {
  std::vector<SegmentLabel> labels;      ///< ascending, canonical, all that read out this instance
  ClassId class_id = ClassId::kUnknown;  ///< most evidence; ties to the lower id
  std::map<ClassId, double> class_probability;  ///< share of the evidence; sums to 1, or is empty
};

/// The read-out of all labels (ALGORITHM 4.6), once per mesh rather than once per vertex.
struct LabelReadOut {
  std::vector<LabelReading> labels;  ///< indexed by canonical label; [0] and dead ones empty
  std::map<InstanceId, InstanceReading> instances;
};

/// `sizes[l]` = how much surface label l has; the class of an instance is the argmax of
/// sum over its labels of Psi(l, c) * sizes[l]. Empty = all labels weigh the same. Labels beyond
/// its end count as size 0. Class 0 (unknown) is never evidence. Unlike the paper's, an instance
/// needs more than one detection in many frames: of those that a detector looked at, the evidence
/// of one of its labels must be a quarter, or more than one frame can give (1).
LabelReadOut ReadLabels(const LabelTable& table, std::span<const double> sizes = {});

/// Indexed by label, merged ones too; all labels weigh the same.
std::vector<ShownLabel> ShowLabels(const LabelTable& table);

/// Vertices per label, indexed by label, 0 for kNone.
std::vector<double> VerticesPerLabel(const Mesh& mesh);

/// Sets instance and class of all vertices from their segment.
void ApplyReadOut(const LabelReadOut& read_out, Mesh* mesh);

}  // namespace vismap
