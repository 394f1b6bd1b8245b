#include "map/mask_bonds.h"

#include <algorithm>
#include <vector>

namespace vismap {
namespace {

float Bounded(float bond) { return std::clamp(bond, -MaskBonds::kMost, MaskBonds::kMost); }

}  // namespace

void MaskBonds::AddFrame(std::span<const MaskedLabel> seen) {
  for (size_t i = 0; i < seen.size(); ++i) {
    for (size_t j = i + 1; j < seen.size(); ++j) {
      const MaskedLabel &a = seen[i], &b = seen[j];
      const Pair pair = std::minmax(a.label, b.label);
      const float amount = std::min(a.evidence, b.evidence);
      if (a.detection == b.detection) {
        float& bond = pairs_[pair];
        bond = Bounded(bond + amount);
      } else if (const auto known = pairs_.find(pair); known != pairs_.end()) {
        known->second = Bounded(known->second - amount);
      }
    }
  }
}

float MaskBonds::Between(SegmentLabel a, SegmentLabel b) const {
  const auto known = pairs_.find(std::minmax(a, b));
  return known == pairs_.end() ? 0 : known->second;
}

void MaskBonds::Merge(SegmentLabel dead, SegmentLabel survivor) {
  std::vector<std::pair<SegmentLabel, float>> inherited;
  for (auto bond = pairs_.begin(); bond != pairs_.end();) {
    const auto [a, b] = bond->first;
    if (a != dead && b != dead) {
      ++bond;
      continue;
    }
    inherited.emplace_back(a == dead ? b : a, bond->second);
    bond = pairs_.erase(bond);
  }
  for (const auto& [partner, amount] : inherited) {
    if (partner == survivor) continue;  // the bond between the two merged labels
    float& bond = pairs_[std::minmax(partner, survivor)];
    bond = Bounded(bond + amount);
  }
}

MaskBonds MaskBonds::Restore(std::map<Pair, float> pairs) {
  MaskBonds bonds;
  bonds.pairs_ = std::move(pairs);
  return bonds;
}

}  // namespace vismap
