#pragma once

#include <array>
#include <map>
#include <optional>

#include "evaluation/matches.h"

namespace vismap {

/// Average precision exactly as ScanNet's evaluate_semantic_instance.py computes it. Table I of the
/// paper very likely uses it with equal confidences; then AP = r (1 + p) / 2 with recall r and
/// precision p. See libs/METHOD.md, Evaluation.

/// The IoU thresholds whose mean is "AP": 0.50 to 0.90. The benchmark calls it 50:95, but its list
/// (numpy's arange) ends before 0.95.
constexpr std::array<double, 9> kScanNetOverlaps{0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9};

/// Which objects and predictions count.
struct ScanNetOptions {
  int64_t min_vertices = 100;  ///< smaller predictions are skipped, smaller objects are void
  /// Confidence of each instance; 0 for an instance that is missing. Not set = all are equal.
  std::optional<std::map<InstanceId, double>> confidence;
};

/// The matches of one class at one IoU threshold.
struct ScanNetEvidence {
  struct Entry {
    double confidence = 0;
    bool is_true = false;
  };
  std::vector<Entry> entries;    ///< matched objects, duplicates, false positives
  int hard_false_negatives = 0;  ///< objects without a match
  int truths = 0;                ///< number of objects that are large enough
  int predictions = 0;           ///< number of predictions that are large enough, also ignored ones

  int true_positives() const;
  int false_positives() const { return static_cast<int>(entries.size()) - true_positives(); }
};

/// Matches the objects and predictions of one class. A prediction is a match if its IoU >
/// `overlap`.
ScanNetEvidence CollectScanNetEvidence(const InstanceMatches& matches, ClassId class_id,
                                       double overlap, const ScanNetOptions& options);

/// The area under the precision-recall curve. None if the class has no object; 0 if it has objects
/// but no predictions.
std::optional<double> IntegrateScanNet(const ScanNetEvidence& evidence);

/// The AP of one class, or means over classes.
struct ScanNetAp {
  std::optional<double> ap25, ap50, ap;  ///< [0, 1]; `ap` = mean over kScanNetOverlaps
};
ScanNetAp ScoreScanNet(const InstanceMatches& matches, ClassId class_id,
                       const ScanNetOptions& options);

}  // namespace vismap
