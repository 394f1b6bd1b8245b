#include "evaluation/ranked_ap.h"

#include <algorithm>
#include <set>

namespace vismap {
namespace {

// The predictions of a class and its aliases that are large enough, highest score first.
std::vector<size_t> RankedPredictions(const InstanceMatches& matches, const EvaluatedClass& known,
                                      const RankedApOptions& options) {
  std::vector<size_t> ranked;
  for (size_t p = 0; p < matches.predictions.size(); ++p) {
    const PredictedInstance& prediction = matches.predictions[p];
    const bool same = prediction.class_id == known.class_id ||
                      std::find(known.aliases.begin(), known.aliases.end(), prediction.class_id) !=
                          known.aliases.end();
    if (same && prediction.vertices >= options.min_prediction_vertices) ranked.push_back(p);
  }
  const auto score = [&](size_t p) {
    const auto found = options.scores.find(matches.predictions[p].instance);
    return found == options.scores.end() ? static_cast<double>(matches.predictions[p].vertices)
                                         : found->second;
  };
  std::stable_sort(ranked.begin(), ranked.end(),
                   [&](size_t a, size_t b) { return score(a) > score(b); });
  return ranked;
}

// The area under the interpolated precision-recall curve. hits[i] = the prediction of rank i
// matches.
double Integrate(const std::vector<bool>& hits, size_t objects) {
  std::vector<double> precision, recall;
  int found = 0;
  for (size_t i = 0; i < hits.size(); ++i) {
    found += hits[i];
    precision.push_back(found / static_cast<double>(i + 1));
    recall.push_back(found / static_cast<double>(objects));
  }
  for (size_t i = precision.size(); i-- > 1;)
    precision[i - 1] = std::max(precision[i - 1], precision[i]);
  double area = 0;
  for (size_t i = 0; i < precision.size(); ++i)
    area += (recall[i] - (i == 0 ? 0 : recall[i - 1])) * precision[i];
  return area;
}

}  // namespace

std::optional<double> ScoreRanked(const InstanceMatches& matches, const EvaluatedClass& known,
                                  double overlap, const RankedApOptions& options) {
  std::vector<size_t> objects;
  for (size_t t = 0; t < matches.truths.size(); ++t) {
    if (matches.truths[t].class_id == known.class_id &&
        matches.truths[t].vertices >= options.min_object_vertices)
      objects.push_back(t);
  }
  if (objects.empty()) return std::nullopt;  // the class does not occur
  std::set<size_t> used;
  std::vector<bool> hits;
  for (const size_t prediction : RankedPredictions(matches, known, options)) {
    double best = 0;
    std::optional<size_t> match;
    for (const size_t object : objects) {
      if (used.contains(object)) continue;  // matched by a prediction with a higher score
      const double iou = matches.Iou(object, prediction);
      if (iou <= best) continue;
      best = iou;
      match = object;
    }
    hits.push_back(best > overlap);
    if (best > overlap) used.insert(*match);
  }
  return Integrate(hits, objects.size());
}

RankedAp ScoreRanked(const InstanceMatches& matches, const EvaluatedClass& known,
                     const RankedApOptions& options) {
  RankedAp score{ScoreRanked(matches, known, 0.5, options), std::nullopt};
  if (!score.ap50) return score;
  double sum = 0;
  for (int i = 0; i < 10; ++i) sum += *ScoreRanked(matches, known, 0.5 + 0.05 * i, options);
  score.ap = sum / 10;
  return score;
}

}  // namespace vismap
