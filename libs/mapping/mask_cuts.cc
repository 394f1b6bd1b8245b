#include "mapping/mask_cuts.h"

#include <algorithm>

namespace vismap {
namespace {

// Share of a label's frames with a detector that its evidence must reach.
constexpr double kLeastShare = 0.25;

bool HasEnoughMasks(const LabelRecord& record, double min_evidence) {
  double evidence = 0;
  for (const auto& [class_id, amount] : record.class_evidence)
    evidence += static_cast<double>(amount);
  return evidence > min_evidence &&
         evidence >= kLeastShare * static_cast<double>(record.frames_with_detector);
}

}  // namespace

MaskCuts::MaskCuts(const FrameAssociation& association, const LabelTable& labels,
                   double min_evidence)
    : cut_from_(association.segments.size(), SegmentLabel::kNone) {
  if (min_evidence <= 0) return;  // no label is kept
  const std::vector<LabelRecord>& records = labels.records();
  kept_.assign(records.size() + 1, 0);
  for (size_t i = 0; i < records.size(); ++i)
    kept_[i + 1] = HasEnoughMasks(records[i], min_evidence);
  for (size_t s = 0; s < cut_from_.size(); ++s) {
    const FrameAssociation::Segment& match = association.segments[s];
    if (Raw(match.label) < kept_.size() && kept_[Raw(match.label)] != 0)
      cut_from_[s] = match.cut_from;
  }
  // A label on a segment of this frame gets its votes from that segment and need not be kept.
  for (const FrameAssociation::Segment& match : association.segments) {
    if (Raw(match.label) < kept_.size()) kept_[Raw(match.label)] = 0;
  }
  any_kept_ = std::any_of(kept_.begin(), kept_.end(), [](uint8_t kept) { return kept != 0; });
  // Voxels may still hold votes for merged labels.
  for (size_t i = 0; any_kept_ && i < records.size(); ++i) {
    if (records[i].merged_into == SegmentLabel::kNone) continue;
    kept_[i + 1] = kept_[Raw(labels.Canonical(records[i].merged_into))];
  }
}

}  // namespace vismap
