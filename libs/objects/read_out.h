#pragma once

#include <map>
#include <span>
#include <vector>

#include "map/label_table.h"
#include "meshing/mesh.h"
#include "meshing/shown_label.h"

namespace vismap {

/// What the map knows of one instance.
struct InstanceReading {
  std::vector<SegmentLabel> labels;  ///< the canonical labels that are read out as it, ascending
  ClassId class_id = ClassId::kUnknown;  ///< most evidence; ties to the lower id
  std::map<ClassId, double>
      class_probability;  ///< share of the class evidence; sums to 1, or empty
};

/// The read-out of all labels: the instance and the class that the evidence speaks for (Grinvald
/// 2019, Sec. III-D; libs/METHOD.md, Labels and instances). It is made once per mesh, not once per
/// vertex.
struct LabelReadOut {
  std::vector<LabelReading> labels;  ///< indexed by label; unset for kNone and merged labels
  std::map<InstanceId, InstanceReading> instances;
};

/// Reads out all labels. `sizes[l]` is the amount of surface of label l, such as its number of
/// vertices: the class of an instance is argmax_c of the sum over its labels of Psi(l, c) *
/// sizes[l]. An empty `sizes` weighs all labels the same; labels beyond its end have size 0. The
/// class kUnknown is never evidence.
///
/// Unlike in the paper, an instance must be confirmed: at least one of its labels must have more
/// evidence for it than one frame can give, which is 1, or evidence in at least a quarter of the
/// frames with a detector that observed the label. Otherwise its labels are read out without an
/// instance.
LabelReadOut ReadLabels(const LabelTable& table, std::span<const double> sizes = {});

/// What each label shows in a mesh, indexed by label, merged labels included. The class of an
/// instance weighs all its labels the same.
std::vector<ShownLabel> ShowLabels(const LabelTable& table);

/// Number of vertices of each label, indexed by label; 0 for kNone.
std::vector<double> VerticesPerLabel(const Mesh& mesh);

/// Sets the instance and the class of all vertices from their segments.
void ApplyReadOut(const LabelReadOut& read_out, Mesh* mesh);

}  // namespace vismap
