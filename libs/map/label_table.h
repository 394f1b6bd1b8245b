#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "map/mask_bonds.h"

namespace vismap {

/// What the map has learnt of one segment label over time.
struct LabelRecord {
  SegmentLabel merged_into =
      SegmentLabel::kNone;                  ///< kNone = alive; otherwise this record is empty
  uint32_t frames = 0;                      ///< F(l): frames in which it was observed
  uint32_t frames_with_detector = 0;        ///< of those, frames that a detector had looked at
  uint64_t pixels = 0;                      ///< sum over those frames of its size in the image
  int64_t first_utime = 0, last_utime = 0;  ///< [us]
  uint32_t cleared_voxels = 0;  ///< of its surface that were seen empty since it was last observed
  int64_t cleared_utime = 0;    ///< when last; 0 = none were [us]
  std::map<InstanceId, float> instance_evidence;  ///< the paper's Phi(l, m)
  std::map<ClassId, float> class_evidence;        ///< the paper's Psi(l, c)
  friend bool operator==(const LabelRecord&, const LabelRecord&) = default;
};

/// Read-out of one label (Grinvald 2019, Sec. III-D): argmax of the evidence.
struct LabelReading {
  InstanceId instance = InstanceId::kNone;
  ClassId class_id = ClassId::kUnknown;
  float confidence = 0;  ///< evidence for the instance per frame with a detector, [0, 1]
};

/// Evidence for (together) and against (apart) two labels being one surface piece.
struct PairEvidence {
  float together = 0;
  float apart = 0;
  friend bool operator==(const PairEvidence&, const PairEvidence&) = default;
};

/// All segment labels of a map with their counts, and which of them turned out to be the same.
/// Labels are 1, 2, ...
class LabelTable {
 public:
  /// The label that `label` was merged into, directly or by steps; itself when alive. kNone stays
  /// kNone.
  SegmentLabel Canonical(SegmentLabel label) const;
  /// The record of an alive label. Throws on unknown or merged labels.
  const LabelRecord& Record(SegmentLabel label) const;
  LabelRecord& MutableRecord(SegmentLabel label);

  /// Read-out of a label (resolved to its canonical one first).
  LabelReading Read(SegmentLabel label) const;

  /// Evidence for each class, per instance: the class evidence of its labels, weighted by their
  /// mean size in the image.
  std::map<InstanceId, std::map<ClassId, float>> InstanceClassEvidence() const;
  /// The class of every instance that some label is read out as: the strongest of its evidence.
  std::map<InstanceId, ClassId> InstanceClasses() const;

  SegmentLabel next_label() const { return static_cast<SegmentLabel>(records_.size() + 1); }
  InstanceId next_instance() const { return next_instance_; }
  /// Appends records until `next` is the next free label.
  void GrowLabels(SegmentLabel next);
  void GrowInstances(InstanceId next);

  /// Merges two alive labels: the larger id dies, all counts go to the survivor, which is returned.
  SegmentLabel Merge(SegmentLabel a, SegmentLabel b);

  /// Labels that are alive, ascending.
  std::vector<SegmentLabel> Alive() const;
  const std::vector<LabelRecord>& records() const {
    return records_;
  }  ///< record of label l at l - 1

  /// Keyed by (smaller, larger) alive label.
  const std::map<std::pair<SegmentLabel, SegmentLabel>, PairEvidence>& pairs() const {
    return pairs_;
  }
  PairEvidence& MutablePair(SegmentLabel a, SegmentLabel b);

  /// Which alive labels masks show as one thing.
  const MaskBonds& bonds() const { return bonds_; }
  MaskBonds& MutableBonds() { return bonds_; }

  /// Fraction of observed frames below which an instance is not read out (published code: 0.1 of
  /// the other frames).
  float min_instance_ratio = 0.1F;

  /// Replaces everything: for loading a saved map.
  static LabelTable Restore(std::vector<LabelRecord> records, InstanceId next_instance,
                            std::map<std::pair<SegmentLabel, SegmentLabel>, PairEvidence> pairs,
                            MaskBonds bonds = {});
  friend bool operator==(const LabelTable&, const LabelTable&) = default;

 private:
  std::vector<LabelRecord> records_;
  InstanceId next_instance_{1};
  std::map<std::pair<SegmentLabel, SegmentLabel>, PairEvidence> pairs_;
  MaskBonds bonds_;
};

}  // namespace vismap
