#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "map/mask_bonds.h"

namespace vismap {

/// What the map knows of one segment label.
struct LabelRecord {
  SegmentLabel merged_into = SegmentLabel::kNone;  ///< kNone = alive; else the record is empty
  uint32_t frames = 0;                             ///< F(l): frames in which it was observed
  uint32_t frames_with_detector = 0;        ///< of `frames`, those that a detector had looked at
  uint64_t pixels = 0;                      ///< its size in the image, summed over `frames` [px]
  int64_t first_utime = 0, last_utime = 0;  ///< of the first and last of `frames` [us]
  uint32_t cleared_voxels = 0;  ///< voxels of its surface carved away since it was last observed
  int64_t cleared_utime = 0;    ///< of the last frame that carved one; 0 = none [us]
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

/// All segment labels of a map, 1, 2, ..., with their records, and which labels have been merged.
class LabelTable {
 public:
  /// The alive label that `label` was merged into, in one or more steps; `label` itself when it is
  /// alive or kNone.
  SegmentLabel Canonical(SegmentLabel label) const;
  /// The record of an alive label. Throws std::logic_error for an unknown or merged label.
  const LabelRecord& Record(SegmentLabel label) const;
  LabelRecord& MutableRecord(SegmentLabel label);

  /// Read-out of a label, or of the one that it was merged into.
  LabelReading Read(SegmentLabel label) const;

  /// Evidence for each class per instance: the class evidence of the labels that are read out as
  /// it, weighted by their mean size in the image [px].
  std::map<InstanceId, std::map<ClassId, float>> InstanceClassEvidence() const;
  /// The class with most evidence of every instance that a label is read out as.
  std::map<InstanceId, ClassId> InstanceClasses() const;

  SegmentLabel next_label() const { return static_cast<SegmentLabel>(records_.size() + 1); }
  InstanceId next_instance() const { return next_instance_; }
  /// Appends records until `next` is the next free label.
  void GrowLabels(SegmentLabel next);
  void GrowInstances(InstanceId next);

  /// Merges two alive labels: all counts of the larger id are added to those of the smaller one,
  /// the survivor, which is returned.
  SegmentLabel Merge(SegmentLabel a, SegmentLabel b);

  /// Labels that are alive, ascending.
  std::vector<SegmentLabel> Alive() const;
  /// The record of label l is at l - 1.
  const std::vector<LabelRecord>& records() const { return records_; }

  /// Keyed by (smaller, larger) alive label.
  const std::map<std::pair<SegmentLabel, SegmentLabel>, PairEvidence>& pairs() const {
    return pairs_;
  }
  PairEvidence& MutablePair(SegmentLabel a, SegmentLabel b);

  /// The bonds that masks make between alive labels.
  const MaskBonds& bonds() const { return bonds_; }
  MaskBonds& MutableBonds() { return bonds_; }

  /// A label is read out as an instance if its evidence for it exceeds this share of the rest of
  /// its frames with a detector (published code: 0.1 of the rest of all frames).
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
