#include "evaluation/panoptic.h"

#include <vector>

namespace vismap {

std::optional<double> PanopticScore::sq() const {
  if (true_positives == 0) return std::nullopt;
  return sum_iou / true_positives;
}

std::optional<double> PanopticScore::rq() const {
  const double all = true_positives + 0.5 * (false_positives + false_negatives);
  if (all == 0) return std::nullopt;
  return true_positives / all;
}

std::optional<double> PanopticScore::pq() const {
  const std::optional<double> recognition = rq();
  if (!recognition) return std::nullopt;
  return *recognition * sq().value_or(0);
}

PanopticScore ScorePanoptic(const InstanceMatches& matches, ClassId class_id,
                            int64_t min_vertices) {
  // Points of each prediction on void or on objects that are too small.
  std::vector<int64_t> on_void;
  for (const PredictedInstance& prediction : matches.predictions)
    on_void.push_back(prediction.on_void);
  for (size_t t = 0; t < matches.truths.size(); ++t) {
    if (matches.truths[t].vertices >= min_vertices) continue;
    for (const auto& [prediction, common] : matches.common[t]) on_void[prediction] += common;
  }
  PanopticScore score;
  std::vector<bool> matched(matches.predictions.size(), false);
  for (size_t t = 0; t < matches.truths.size(); ++t) {
    const TruthInstance& truth = matches.truths[t];
    if (truth.class_id != class_id || truth.vertices < min_vertices) continue;
    ++score.false_negatives;
    for (const auto& [p, common] : matches.common[t]) {
      const PredictedInstance& prediction = matches.predictions[p];
      if (prediction.class_id != class_id || prediction.vertices < min_vertices) continue;
      const double iou =
          static_cast<double>(common) /
          static_cast<double>(truth.vertices + prediction.vertices - on_void[p] - common);
      if (iou <= 0.5) continue;  // an object has at most one prediction above 0.5
      matched[p] = true;
      score.sum_iou += iou;
      ++score.true_positives;
      --score.false_negatives;
    }
  }
  for (size_t p = 0; p < matches.predictions.size(); ++p) {
    const PredictedInstance& prediction = matches.predictions[p];
    if (prediction.class_id != class_id || prediction.vertices < min_vertices || matched[p])
      continue;
    if (2 * on_void[p] <= prediction.vertices) ++score.false_positives;
  }
  return score;
}

}  // namespace vismap
