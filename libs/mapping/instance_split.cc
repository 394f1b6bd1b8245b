#include "mapping/instance_split.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace vismap {
namespace {

/// The labels of an instance, divided between two of them.
struct Sides {
  std::vector<SegmentLabel> first, second;
};

float BondTo(const std::vector<SegmentLabel>& side, SegmentLabel label, const MaskBonds& bonds) {
  float sum = 0;
  for (const SegmentLabel other : side) sum += bonds.Between(label, other);
  return sum;
}

// The label whose bonds differ most between the sides goes first, ties to the lower label, since
// its bonds then count for the rest. Labels without a difference join no side.
Sides Divide(SegmentLabel a, SegmentLabel b, std::vector<SegmentLabel> others,
             const MaskBonds& bonds) {
  Sides sides{{a}, {b}};
  while (!others.empty()) {
    auto next = others.begin();
    float most = 0;
    for (auto other = others.begin(); other != others.end(); ++other) {
      const float lean = BondTo(sides.first, *other, bonds) - BondTo(sides.second, *other, bonds);
      if (std::abs(lean) <= std::abs(most)) continue;
      most = lean;
      next = other;
    }
    if (most == 0) break;  // no label that is left has bonds to decide by
    (most > 0 ? sides.first : sides.second).push_back(*next);
    others.erase(next);
  }
  return sides;
}

// Evidence of a label for an instance, weighted by the label's mean size in the image [px].
double Amount(const LabelRecord& record, InstanceId instance) {
  const auto found = record.instance_evidence.find(instance);
  if (found == record.instance_evidence.end()) return 0;
  return static_cast<double>(found->second) * static_cast<double>(record.pixels) /
         std::max(record.frames, 1u);
}

double Amount(const std::vector<SegmentLabel>& side, InstanceId instance,
              const LabelTable& labels) {
  double sum = 0;
  for (const SegmentLabel label : side) sum += Amount(labels.Record(label), instance);
  return sum;
}

std::vector<SegmentLabel> LabelsOf(InstanceId instance, const LabelTable& labels) {
  std::vector<SegmentLabel> found;
  for (const SegmentLabel label : labels.Alive()) {
    if (labels.Read(label).instance == instance) found.push_back(label);
  }
  return found;
}

// The instance for which this side has most evidence among those that no label reads out as, ties
// to the lower one; a new instance when there is none.
InstanceId InstanceFor(const std::vector<SegmentLabel>& side, InstanceId from, LabelTable* labels) {
  std::map<InstanceId, double> amounts;
  for (const SegmentLabel label : side) {
    for (const auto& [instance, evidence] : labels->Record(label).instance_evidence)
      amounts[instance] += Amount(labels->Record(label), instance);
  }
  amounts.erase(from);
  for (const SegmentLabel label : labels->Alive()) amounts.erase(labels->Read(label).instance);
  InstanceId best = labels->next_instance();
  double most = 0;
  for (const auto& [instance, amount] : amounts) {
    if (amount <= most) continue;
    most = amount;
    best = instance;
  }
  if (best == labels->next_instance())
    labels->GrowInstances(static_cast<InstanceId>(Raw(best) + 1));
  return best;
}

Sides DivideLabelsOf(InstanceId instance, SegmentLabel a, SegmentLabel b,
                     const LabelTable& labels) {
  std::vector<SegmentLabel> others = LabelsOf(instance, labels);
  std::erase_if(others, [&](SegmentLabel label) { return label == a || label == b; });
  return Divide(a, b, std::move(others), labels.bonds());
}

InstanceSplit Split(InstanceId instance, const Sides& sides, LabelTable* labels) {
  const bool first_leaves =
      Amount(sides.first, instance, *labels) < Amount(sides.second, instance, *labels);
  const std::vector<SegmentLabel>& leaving = first_leaves ? sides.first : sides.second;
  const InstanceId to = InstanceFor(leaving, instance, labels);
  for (const SegmentLabel label : leaving) {
    auto& evidence = labels->MutableRecord(label).instance_evidence;
    evidence[to] += evidence[instance];
    evidence.erase(instance);
  }
  return {instance, to};
}

// The two labels of the instance with the lowest bond, ties to the lower labels.
MaskBonds::Pair LeastBound(InstanceId instance, const LabelTable& labels) {
  MaskBonds::Pair least;
  float lowest = MaskBonds::kMost;
  for (const auto& [pair, bond] : labels.bonds().pairs()) {
    if (bond >= lowest || labels.Read(pair.first).instance != instance ||
        labels.Read(pair.second).instance != instance)
      continue;
    lowest = bond;
    least = pair;
  }
  return least;
}

// Divides the labels of an instance from the two with the lowest bond. Returns the sides if the
// bonds between them, taken together, show two objects, see the header; else both are empty.
Sides DivideByAllBonds(InstanceId instance, double split_frames, const LabelTable& labels) {
  const auto [a, b] = LeastBound(instance, labels);
  if (labels.bonds().Between(a, b) > -split_frames / 2) return {};
  Sides sides = DivideLabelsOf(instance, a, b, labels);
  float between = 0;
  for (const SegmentLabel label : sides.first)
    between += BondTo(sides.second, label, labels.bonds());
  return between <= -split_frames ? sides : Sides{};
}

}  // namespace

std::vector<InstanceSplit> SplitInstances(std::span<const MaskedLabel> seen, double split_frames,
                                          LabelTable* labels) {
  labels->MutableBonds().AddFrame(seen);
  std::vector<InstanceSplit> splits;
  if (split_frames <= 0) return splits;
  std::set<InstanceId> examined;
  for (size_t i = 0; i < seen.size(); ++i) {
    for (size_t j = i + 1; j < seen.size(); ++j) {
      if (seen[i].detection == seen[j].detection) continue;
      const auto [a, b] = std::minmax(seen[i].label, seen[j].label);
      const InstanceId instance = labels->Read(a).instance;
      if (instance == InstanceId::kNone || labels->Read(b).instance != instance) continue;
      Sides sides;
      if (labels->bonds().Between(a, b) <= -split_frames) {
        sides = DivideLabelsOf(instance, a, b, *labels);
      } else if (examined.insert(instance).second) {
        sides = DivideByAllBonds(instance, split_frames, *labels);
      }
      if (!sides.first.empty()) splits.push_back(Split(instance, sides, labels));
    }
  }
  return splits;
}

}  // namespace vismap
