#include "map/label_table.h"

#include <algorithm>

#include "base/require.h"

namespace vismap {
namespace {

// The key with the most evidence; ties go to the lower key.
template <typename Key>
std::pair<Key, float> Strongest(const std::map<Key, float>& evidence) {
  std::pair<Key, float> best{Key{}, 0.0F};
  for (const auto& entry : evidence) {
    if (entry.second > best.second) best = entry;
  }
  return best;
}

}  // namespace

SegmentLabel LabelTable::Canonical(SegmentLabel label) const {
  while (label != SegmentLabel::kNone && Raw(label) <= records_.size()) {
    const SegmentLabel next = records_[Raw(label) - 1].merged_into;
    if (next == SegmentLabel::kNone) break;
    label = next;
  }
  return label;
}

const LabelRecord& LabelTable::Record(SegmentLabel label) const {
  Require(label != SegmentLabel::kNone && Raw(label) <= records_.size(), "unknown segment label");
  const LabelRecord& record = records_[Raw(label) - 1];
  Require(record.merged_into == SegmentLabel::kNone, "record of a merged segment label");
  return record;
}

LabelRecord& LabelTable::MutableRecord(SegmentLabel label) {
  return const_cast<LabelRecord&>(Record(label));
}

LabelReading LabelTable::Read(SegmentLabel label) const {
  const SegmentLabel alive = Canonical(label);
  if (alive == SegmentLabel::kNone || Raw(alive) > records_.size()) return {};
  const LabelRecord& record = records_[Raw(alive) - 1];
  const auto [instance, evidence] = Strongest(record.instance_evidence);
  const auto looked = static_cast<float>(record.frames_with_detector);
  if (evidence <= min_instance_ratio * (looked - evidence)) return {};
  return {instance, Strongest(record.class_evidence).first,
          std::clamp(evidence / std::max(looked, 1.0F), 0.0F, 1.0F)};
}

std::map<InstanceId, std::map<ClassId, float>> LabelTable::InstanceClassEvidence() const {
  std::map<InstanceId, std::map<ClassId, float>> evidence;
  for (const SegmentLabel label : Alive()) {
    const InstanceId instance = Read(label).instance;
    if (instance == InstanceId::kNone) continue;
    const LabelRecord& record = Record(label);
    const float mean_pixels =
        static_cast<float>(record.pixels) / static_cast<float>(std::max(record.frames, 1u));
    for (const auto& [class_id, amount] : record.class_evidence) {
      evidence[instance][class_id] += amount * mean_pixels;
    }
  }
  return evidence;
}

std::map<InstanceId, ClassId> LabelTable::InstanceClasses() const {
  std::map<InstanceId, ClassId> classes;
  for (const auto& [instance, evidence] : InstanceClassEvidence()) {
    classes[instance] = Strongest(evidence).first;
  }
  return classes;
}

void LabelTable::GrowLabels(SegmentLabel next) {
  Require(Raw(next) >= 1, "the next free label is at least 1");
  if (Raw(next) - 1 > records_.size()) records_.resize(Raw(next) - 1);
}

void LabelTable::GrowInstances(InstanceId next) { next_instance_ = std::max(next_instance_, next); }

SegmentLabel LabelTable::Merge(SegmentLabel a, SegmentLabel b) {
  Require(a != b, "a label cannot merge with itself");
  const SegmentLabel survivor = std::min(a, b), dead = std::max(a, b);
  LabelRecord& to = MutableRecord(survivor);
  LabelRecord from = std::move(MutableRecord(dead));
  records_[Raw(dead) - 1] = LabelRecord{};
  records_[Raw(dead) - 1].merged_into = survivor;
  if (from.frames > 0) {
    to.first_utime = to.frames > 0 ? std::min(to.first_utime, from.first_utime) : from.first_utime;
    to.last_utime = to.frames > 0 ? std::max(to.last_utime, from.last_utime) : from.last_utime;
  }
  to.cleared_voxels += from.cleared_voxels;
  to.cleared_utime = std::max(to.cleared_utime, from.cleared_utime);
  to.frames += from.frames;
  to.frames_with_detector += from.frames_with_detector;
  to.pixels += from.pixels;
  for (const auto& [instance, amount] : from.instance_evidence)
    to.instance_evidence[instance] += amount;
  for (const auto& [class_id, amount] : from.class_evidence) to.class_evidence[class_id] += amount;

  std::vector<std::pair<SegmentLabel, PairEvidence>> inherited;  // by partner of the dead label
  for (auto pair = pairs_.begin(); pair != pairs_.end();) {
    const auto [x, y] = pair->first;
    if (x != dead && y != dead) {
      ++pair;
      continue;
    }
    inherited.emplace_back(x == dead ? y : x, pair->second);
    pair = pairs_.erase(pair);
  }
  for (const auto& [partner, evidence] : inherited) {
    if (partner == survivor) continue;  // the pair of the two merged labels
    PairEvidence& sum = pairs_[std::minmax(survivor, partner)];
    sum.together += evidence.together;
    sum.apart += evidence.apart;
  }
  bonds_.Merge(dead, survivor);
  return survivor;
}

std::vector<SegmentLabel> LabelTable::Alive() const {
  std::vector<SegmentLabel> alive;
  for (size_t i = 0; i < records_.size(); ++i) {
    if (records_[i].merged_into == SegmentLabel::kNone)
      alive.push_back(static_cast<SegmentLabel>(i + 1));
  }
  return alive;
}

PairEvidence& LabelTable::MutablePair(SegmentLabel a, SegmentLabel b) {
  Require(a != b, "a pair has two labels");
  return pairs_[std::minmax(a, b)];
}

LabelTable LabelTable::Restore(std::vector<LabelRecord> records, InstanceId next_instance,
                               std::map<std::pair<SegmentLabel, SegmentLabel>, PairEvidence> pairs,
                               MaskBonds bonds) {
  LabelTable table;
  table.records_ = std::move(records);
  table.next_instance_ = next_instance;
  table.pairs_ = std::move(pairs);
  table.bonds_ = std::move(bonds);
  return table;
}

}  // namespace vismap
