#pragma once

#include <array>
#include <map>
#include <optional>

#include "evaluation/matches.h"

namespace vismap {

/// Average precision exactly as ScanNet's evaluate_semantic_instance.py computes it
/// (ALGORITHM 7.4), which the paper's Table I very likely is with all confidences equal (7.5): then
/// AP = r (1 + p) / 2.

/// Overlaps that "AP" is the mean over: 0.50 to 0.90. The benchmark calls it 50:95, but its list
/// (numpy's arange) stops before 0.95.
constexpr std::array<double, 9> kScanNetOverlaps{0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9};

struct ScanNetOptions {
  int64_t min_vertices = 100;  ///< smaller predictions are skipped, smaller objects are void
  /// Of each instance; one that is missing has 0. None = all are equal.
  std::optional<std::map<InstanceId, double>> confidence;
};

/// What became of the objects of one class at one overlap, before any precision.
struct ScanNetEvidence {
  struct Entry {
    double confidence = 0;
    bool is_true = false;
  };
  std::vector<Entry> entries;    ///< matched objects, duplicates, false positives
  int hard_false_negatives = 0;  ///< objects without a match
  int truths = 0;                ///< large enough ones
  int predictions = 0;           ///< large enough ones, ignored ones included

  int true_positives() const;
  int false_positives() const { return static_cast<int>(entries.size()) - true_positives(); }
};

/// The matching of one class. A prediction is a match at IoU > `overlap`.
ScanNetEvidence CollectScanNetEvidence(const InstanceMatches& matches, ClassId class_id,
                                       double overlap, const ScanNetOptions& options);

/// The area under the precision-recall curve. None = the class has no object here; 0 = it has, but
/// nothing was predicted.
std::optional<double> IntegrateScanNet(const ScanNetEvidence& evidence);

/// Of one class, or means over classes.
struct ScanNetAp {
  std::optional<double> ap25, ap50, ap;  ///< [0, 1]; `ap` = mean over kScanNetOverlaps
};
ScanNetAp ScoreScanNet(const InstanceMatches& matches, ClassId class_id,
                       const ScanNetOptions& options);

}  // namespace vismap
