#include "association/label_matching.h"

#include <algorithm>

namespace vismap {
namespace {

/// The overlaps while labels are assigned. Each count of points belongs to one choice of its
/// voxels, and passes to the next one when another segment gets that label; no point is counted
/// again.
class CurrentOverlaps {
 public:
  explicit CurrentOverlaps(const FrameCounts& counts) : counts_(counts.choices) {
    for (const ChoiceCount& count : counts_) {
      for (const SegmentLabel label : count.choices) {
        if (label != SegmentLabel::kNone) overlaps_.push_back({count.segment, label, 0});
      }
    }
    std::sort(overlaps_.begin(), overlaps_.end(), Before);
    overlaps_.erase(std::unique(overlaps_.begin(), overlaps_.end(), SamePair), overlaps_.end());
    choice_.assign(counts_.size(), 0);
    for (size_t i = 0; i < counts_.size(); ++i) AddPoints(i);
  }

  /// The largest overlap above `min_points` of a segment and a label that are both not matched;
  /// nullptr = none.
  const LabelOverlap* Largest(int64_t min_points, const LabelMatching& matching,
                              const std::vector<bool>& labelled) const {
    const LabelOverlap* best = nullptr;
    int64_t most = min_points;
    for (const LabelOverlap& overlap : overlaps_) {
      if (overlap.points <= most || labelled[static_cast<size_t>(overlap.segment)] ||
          matching.segment_of.contains(overlap.label)) {
        continue;
      }
      most = overlap.points;
      best = &overlap;
    }
    return best;
  }

  /// Gives `label` to `segment`: points of other segments that chose it pass to their next choice.
  void Assign(SegmentLabel label, int32_t segment, const LabelMatching& matching) {
    for (size_t i = 0; i < counts_.size(); ++i) {
      if (counts_[i].segment == segment || Choice(i) != label) continue;
      Find(counts_[i].segment, label)->points -= counts_[i].points;
      while (Choice(i) != SegmentLabel::kNone && BelongsToOther(i, matching)) ++choice_[i];
      AddPoints(i);
    }
  }

  std::vector<LabelOverlap> NotEmpty() const {
    std::vector<LabelOverlap> left;
    std::copy_if(overlaps_.begin(), overlaps_.end(), std::back_inserter(left),
                 [](const LabelOverlap& overlap) { return overlap.points > 0; });
    return left;
  }

 private:
  static bool Before(const LabelOverlap& a, const LabelOverlap& b) {
    return a.segment != b.segment ? a.segment < b.segment : a.label < b.label;
  }
  static bool SamePair(const LabelOverlap& a, const LabelOverlap& b) {
    return a.segment == b.segment && a.label == b.label;
  }
  SegmentLabel Choice(size_t i) const {
    return choice_[i] < kVoteSlots ? counts_[i].choices[choice_[i]] : SegmentLabel::kNone;
  }
  bool BelongsToOther(size_t i, const LabelMatching& matching) const {
    const auto owner = matching.segment_of.find(Choice(i));
    return owner != matching.segment_of.end() && owner->second != counts_[i].segment;
  }
  std::vector<LabelOverlap>::iterator Find(int32_t segment, SegmentLabel label) {
    return std::lower_bound(overlaps_.begin(), overlaps_.end(), LabelOverlap{segment, label, 0},
                            Before);
  }
  void AddPoints(size_t i) {
    if (Choice(i) != SegmentLabel::kNone)
      Find(counts_[i].segment, Choice(i))->points += counts_[i].points;
  }

  const std::vector<ChoiceCount>& counts_;
  std::vector<size_t> choice_;          // the present choice of each count
  std::vector<LabelOverlap> overlaps_;  // every pair that can have points, ascending
};

}  // namespace

LabelMatching MatchLabels(const FrameCounts& counts, int64_t min_points) {
  LabelMatching matching;
  std::vector<bool> labelled(counts.points.size(), false);
  CurrentOverlaps overlaps(counts);
  for (;;) {
    const LabelOverlap* best = overlaps.Largest(min_points, matching, labelled);
    if (best == nullptr) break;
    const auto [segment, label, points] = *best;
    matching.segment_of[label] = segment;
    labelled[static_cast<size_t>(segment)] = true;
    overlaps.Assign(label, segment, matching);
  }
  matching.overlaps = overlaps.NotEmpty();
  return matching;
}

}  // namespace vismap
