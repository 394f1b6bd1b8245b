#pragma once

#include <cstdint>
#include <vector>

#include "association/associate.h"

namespace vismap {

/// Keeps labels that only masks can separate from their surroundings, such as a book on a table.
/// Depth shows no edge between the two, so in every frame without a mask of the book the segment of
/// the table covers both, and its votes would take over the book's voxels. But a missing mask is no
/// evidence against the book: its label is kept in such a frame. Not in the paper; see "Kept
/// labels" in libs/METHOD.md, Labels and instances.
class MaskCuts {
 public:
  /// `labels`: the table before the evidence of this frame is added. A label has enough evidence of
  /// masks when its class evidence, summed over the classes, exceeds `min_evidence` [frames x score
  /// x overlap] and is at least a quarter of its frames with a detector. 0 = no label has enough.
  MaskCuts(const FrameAssociation& association, const LabelTable& labels, double min_evidence);

  /// Whether a label, alive or merged, is kept: it has enough evidence of masks and is on no
  /// segment of this frame. Then the frame adds no votes at voxels where the label leads, and no
  /// evidence for merging it with another label.
  bool IsKept(SegmentLabel label) const {
    return Raw(label) < kept_.size() && kept_[Raw(label)] != 0;
  }
  /// Whether any label is kept.
  bool any_kept() const { return any_kept_; }
  /// The alive label that a mask has cut this segment out of, when the segment's own label has
  /// enough evidence of masks; kNone = none.
  SegmentLabel CutFrom(size_t segment) const { return cut_from_[segment]; }

 private:
  bool any_kept_ = false;
  std::vector<uint8_t> kept_;           // by label
  std::vector<SegmentLabel> cut_from_;  // by segment
};

}  // namespace vismap
