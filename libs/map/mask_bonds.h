#pragma once

#include <map>
#include <span>
#include <utility>

#include "base/ids.h"

namespace vismap {

/// A label of the map under a mask of a frame.
struct MaskedLabel {
  SegmentLabel label = SegmentLabel::kNone;
  DetectionIndex detection = DetectionIndex::kNone;
  float evidence = 0;  ///< score of the detection x overlap of mask and segment, [0, 1]
};

/// How strongly masks bind labels to each other: positive = masks show them as one object, negative
/// = as several. Every frame changes the bond B of two labels, with e = the smaller of their
/// evidence:
///   both under one mask:     B <- min(B + e, kMost)
///   under different masks:   B <- max(B - e, -kMost), if they have been under one mask before
///   one of them under none:  B stays
/// The limit keeps early frames, however many, from outweighing later ones.
class MaskBonds {
 public:
  using Pair = std::pair<SegmentLabel, SegmentLabel>;  // the smaller first
  static constexpr float kMost = 5;

  /// Updates the bonds between the labels under the masks of one frame, each label once.
  void AddFrame(std::span<const MaskedLabel> seen);
  /// The bond of two labels; 0 if they were never under one mask.
  float Between(SegmentLabel a, SegmentLabel b) const;
  /// Adds all bonds of `dead` to those of `survivor`.
  void Merge(SegmentLabel dead, SegmentLabel survivor);

  /// The bonds of all pairs that have been under one mask.
  const std::map<Pair, float>& pairs() const { return pairs_; }
  /// Replaces everything: for loading a saved map.
  static MaskBonds Restore(std::map<Pair, float> pairs);
  friend bool operator==(const MaskBonds&, const MaskBonds&) = default;

 private:
  std::map<Pair, float> pairs_;
};

}  // namespace vismap
