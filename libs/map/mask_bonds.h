#pragma once

#include <map>
#include <span>
#include <utility>

#include "base/ids.h"

namespace vismap {

/// A label of the map that lies under a mask of a frame.
struct MaskedLabel {
  SegmentLabel label = SegmentLabel::kNone;
  DetectionIndex detection = DetectionIndex::kNone;
  float evidence = 0;  ///< how surely, [0, 1]
};

/// Whether masks show labels as one thing or as several. The bond of two labels grows by the weaker
/// evidence of both in every frame that has them under one mask, and shrinks by it in every frame
/// that has them under two. It stays within +-kMost, so that no early frames, however many, are
/// beyond what later ones can say. A frame in which one of them has no mask says nothing.
class MaskBonds {
 public:
  using Pair = std::pair<SegmentLabel, SegmentLabel>;  // the smaller first
  static constexpr float kMost = 5;

  /// Labels under the masks of one frame, each label once.
  void Note(std::span<const MaskedLabel> seen);
  /// 0 for labels that were never under one mask.
  float Between(SegmentLabel a, SegmentLabel b) const;
  /// All bonds of `dead` go to `survivor`.
  void Merge(SegmentLabel dead, SegmentLabel survivor);

  /// Of all labels that were under one mask once.
  const std::map<Pair, float>& pairs() const { return pairs_; }
  /// Replaces everything: for loading a saved map.
  static MaskBonds Restore(std::map<Pair, float> pairs);
  friend bool operator==(const MaskBonds&, const MaskBonds&) = default;

 private:
  std::map<Pair, float> pairs_;
};

}  // namespace vismap
