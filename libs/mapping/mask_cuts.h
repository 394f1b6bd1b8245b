#pragma once

#include <cstdint>
#include <vector>

#include "association/associate.h"

namespace vismap {

/// What masks of earlier frames say against votes of this one. A thing that only masks tell from
/// what it lies on (a book on a table) is under none in most frames, and then its surface would
/// vote for the other: but a missing mask is no evidence. Not in the paper.
class MaskCuts {
 public:
  /// `labels`: before the frame adds to them; must stay as they are. Labels with more evidence of
  /// masks than `min_evidence`, and in a quarter of the frames that a detector looked at, count;
  /// 0 = none does.
  MaskCuts(const FrameAssociation& association, const LabelTable& labels, double min_evidence);

  /// Whether masks have shown a label, canonical or merged, which this frame does not show: where a
  /// voxel votes for it most, the frame has nothing to say, nor whether others are the same as it.
  bool IsKept(SegmentLabel label) const {
    return Raw(label) < kept_.size() && kept_[Raw(label)] != 0;
  }
  bool any_kept() const { return any_kept_; }
  /// The canonical label out of which a mask has cut a segment again; kNone = none.
  SegmentLabel CutFrom(size_t segment) const { return cut_from_[segment]; }

 private:
  bool any_kept_ = false;
  std::vector<uint8_t> kept_;  // by label
  std::vector<SegmentLabel> cut_from_;
};

}  // namespace vismap
