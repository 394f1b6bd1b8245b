#include "evaluation/scannet_ap.h"

#include <algorithm>
#include <set>

namespace vismap {
namespace {

// Matches the objects and predictions of one class at one IoU threshold, as ScanNet's script does.
// Comments give the names of the script's variables.
class Matcher {
 public:
  Matcher(const InstanceMatches& matches, ClassId class_id, double overlap,
          const ScanNetOptions& options)
      : matches_(matches), overlap_(overlap), options_(options) {
    for (size_t t = 0; t < matches.truths.size(); ++t) {
      if (matches.truths[t].class_id == class_id) truths_.push_back(t);
    }
    for (size_t p = 0; p < matches.predictions.size(); ++p) {
      const PredictedInstance& prediction = matches.predictions[p];
      if (prediction.class_id == class_id && prediction.vertices >= options.min_vertices)
        predictions_.push_back(p);
    }
  }

  ScanNetEvidence Run() {
    evidence_.predictions = static_cast<int>(predictions_.size());
    for (const size_t truth : truths_) {
      if (IsLarge(truth)) MatchTruth(truth);
    }
    for (const size_t prediction : predictions_) CheckUnmatched(prediction);
    return evidence_;
  }

 private:
  bool IsLarge(size_t truth) const {
    return matches_.truths[truth].vertices >= options_.min_vertices;
  }

  double Confidence(size_t prediction) const {
    if (!options_.confidence) return 1;
    const auto found = options_.confidence->find(matches_.predictions[prediction].instance);
    return found == options_.confidence->end() ? 0 : found->second;
  }

  // The first unused prediction that overlaps enough is the match, and is marked as used. For every
  // further one, the lower one of the two confidences becomes a false positive. As in the script, a
  // further prediction is not marked as used.
  void MatchTruth(size_t truth) {
    ++evidence_.truths;
    std::optional<double> score;
    for (const size_t prediction : predictions_) {
      if (used_.contains(prediction) || matches_.Common(truth, prediction) == 0) continue;
      if (matches_.Iou(truth, prediction) <= overlap_) continue;
      const double confidence = Confidence(prediction);
      if (score) {
        evidence_.entries.push_back({std::min(*score, confidence), false});
        score = std::max(*score, confidence);
      } else {
        score = confidence;
        used_.insert(prediction);
      }
    }
    if (score) {
      evidence_.entries.push_back({*score, true});
    } else {
      ++evidence_.hard_false_negatives;
    }
  }

  // A prediction that overlaps no object of its class enough, including small and matched objects,
  // is a false positive, unless too much of it is on void (void_intersection) or on small objects.
  void CheckUnmatched(size_t prediction) {
    int64_t ignored = matches_.predictions[prediction].on_void;
    for (const size_t truth : truths_) {
      if (matches_.Common(truth, prediction) == 0) continue;
      if (matches_.Iou(truth, prediction) > overlap_) return;  // not a false positive
      if (!IsLarge(truth)) ignored += matches_.Common(truth, prediction);
    }
    const double share = static_cast<double>(ignored) /
                         static_cast<double>(matches_.predictions[prediction].vertices);
    if (share <= overlap_) evidence_.entries.push_back({Confidence(prediction), false});
  }

  const InstanceMatches& matches_;
  const double overlap_;
  const ScanNetOptions& options_;
  std::vector<size_t> truths_, predictions_;  // indices of those of the class, ascending
  std::set<size_t> used_;                     // pred_visited
  ScanNetEvidence evidence_;
};

}  // namespace

int ScanNetEvidence::true_positives() const {
  return static_cast<int>(
      std::count_if(entries.begin(), entries.end(), [](const Entry& e) { return e.is_true; }));
}

ScanNetEvidence CollectScanNetEvidence(const InstanceMatches& matches, ClassId class_id,
                                       double overlap, const ScanNetOptions& options) {
  return Matcher(matches, class_id, overlap, options).Run();
}

std::optional<double> IntegrateScanNet(const ScanNetEvidence& evidence) {
  if (evidence.truths == 0) return std::nullopt;
  if (evidence.predictions == 0) return 0;
  // For each distinct confidence, lowest first: the number of entries with that confidence.
  struct Count {
    int true_positives = 0, all = 0;
  };
  std::map<double, Count> counts;
  for (const ScanNetEvidence::Entry& entry : evidence.entries) {
    ++counts[entry.confidence].all;
    counts[entry.confidence].true_positives += entry.is_true;
  }
  const int objects = evidence.true_positives() + evidence.hard_false_negatives;
  std::vector<double> precision{1}, recall{0};  // the appended point; then by descending confidence
  Count sum;
  for (auto count = counts.rbegin(); count != counts.rend(); ++count) {
    sum.true_positives += count->second.true_positives;
    sum.all += count->second.all;
    precision.push_back(static_cast<double>(sum.true_positives) / sum.all);
    recall.push_back(static_cast<double>(sum.true_positives) / objects);
  }
  // Each precision has the weight (recall after it - recall before it) / 2. At the two ends, the
  // missing recall is that of the end itself (0 at the appended point).
  double area = 0;
  for (size_t i = 0; i < precision.size(); ++i) {
    const double before = i == 0 ? 0 : recall[i - 1];
    const double after = i + 1 == recall.size() ? recall[i] : recall[i + 1];
    area += precision[i] * 0.5 * (after - before);
  }
  return area;
}

ScanNetAp ScoreScanNet(const InstanceMatches& matches, ClassId class_id,
                       const ScanNetOptions& options) {
  const auto at = [&](double overlap) {
    return IntegrateScanNet(CollectScanNetEvidence(matches, class_id, overlap, options));
  };
  ScanNetAp score{at(0.25), at(0.5), std::nullopt};
  if (!score.ap50) return score;
  double sum = 0;
  for (const double overlap : kScanNetOverlaps) sum += *at(overlap);
  score.ap = sum / static_cast<double>(kScanNetOverlaps.size());
  return score;
}

}  // namespace vismap
