#include "evaluation/evaluation.h"

#include <algorithm>

namespace vismap {
namespace {

// The mean of the values that are set.
class Mean {
 public:
  void Add(const std::optional<double>& value) {
    if (value) sum_ += *value;
    count_ += value.has_value();
  }
  std::optional<double> value() const {
    return count_ == 0 ? std::nullopt : std::optional(sum_ / count_);
  }

 private:
  double sum_ = 0;
  int count_ = 0;
};

ScanNetAp MeanAp(const std::vector<ScanNetAp>& scores) {
  Mean ap25, ap50, ap;
  for (const ScanNetAp& score : scores) {
    ap25.Add(score.ap25);
    ap50.Add(score.ap50);
    ap.Add(score.ap);
  }
  return {ap25.value(), ap50.value(), ap.value()};
}

ClassEvaluation EvaluateClass(const InstanceMatches& matches, const EvaluatedClass& known,
                              const EvaluationOptions& options) {
  ScanNetOptions constant = options.scannet;
  constant.confidence.reset();
  ClassEvaluation result;
  result.known = known;
  result.at50 = CollectScanNetEvidence(matches, known.class_id, 0.5, constant);
  result.constant = ScoreScanNet(matches, known.class_id, constant);
  if (options.scannet.confidence)
    result.with_score = ScoreScanNet(matches, known.class_id, options.scannet);
  result.ranked = ScoreRanked(matches, known, options.ranked);
  result.panoptic = ScorePanoptic(matches, known.class_id, options.panoptic_min_vertices);
  return result;
}

void SetMeans(Evaluation* evaluation) {
  std::vector<ScanNetAp> constant, with_score;
  Mean ranked50, ranked, pq, sq, rq;
  for (const ClassEvaluation& result : evaluation->classes) {
    constant.push_back(result.constant);
    if (result.with_score) with_score.push_back(*result.with_score);
    ranked50.Add(result.ranked.ap50);
    ranked.Add(result.ranked.ap);
    pq.Add(result.panoptic.pq());
    sq.Add(result.panoptic.sq());
    rq.Add(result.panoptic.rq());
  }
  evaluation->constant_mean = MeanAp(constant);
  if (!with_score.empty()) evaluation->score_mean = MeanAp(with_score);
  evaluation->ranked_mean = {ranked50.value(), ranked.value()};
  evaluation->panoptic = {pq.value(), sq.value(), rq.value()};
}

// Scores all objects without their classes.
void EvaluateAnyClass(const GroundTruth& truth, const TransferredLabels& labels,
                      const InstanceMatches& groups, const EvaluationOptions& options,
                      Evaluation* evaluation) {
  ScanNetOptions constant = options.scannet;
  constant.confidence.reset();
  evaluation->any_class_ap = ScoreScanNet(groups, ClassId::kUnknown, constant);
  if (options.scannet.confidence)
    evaluation->any_class_score_ap = ScoreScanNet(groups, ClassId::kUnknown, options.scannet);
  evaluation->any_class_panoptic =
      ScorePanoptic(groups, ClassId::kUnknown, options.panoptic_min_vertices);
  evaluation->any_class = ScoreAnyClass(truth, labels, groups, options.discovery);
  evaluation->truths = truth.objects;
  evaluation->findings =
      FindObjects(truth, MatchGroupsAndStructure(truth, labels), options.discovery);
}

}  // namespace

Evaluation Evaluate(const GroundTruth& truth, const EvaluatedMap& map,
                    const std::vector<EvaluatedClass>& classes, EvaluationOptions options) {
  options.scannet.confidence = map.scores;
  if (map.scores) options.ranked.scores = *map.scores;
  const TransferredLabels labels = TransferLabels(truth, map.mesh, options.radius);
  const InstanceMatches instances = MatchInstances(truth, labels, classes);
  const InstanceMatches groups = MatchGroups(truth, labels);
  Evaluation evaluation;
  evaluation.truth_name = truth.name;
  evaluation.truth_format = truth.format;
  evaluation.truth_points = truth.points_W.size();
  evaluation.truth_objects = groups.truths.size();
  evaluation.map_vertices = map.mesh.vertices.size();
  for (const PredictedInstance& prediction : instances.predictions) {
    evaluation.pred_instances += prediction.class_id != ClassId::kUnknown &&
                                 prediction.vertices >= options.ranked.min_prediction_vertices;
  }
  for (const EvaluatedClass& known : classes)
    evaluation.classes.push_back(EvaluateClass(instances, known, options));
  SetMeans(&evaluation);
  EvaluateAnyClass(truth, labels, groups, options, &evaluation);
  evaluation.surface = ScoreSurface(truth, map.mesh, labels, options.radius);
  return evaluation;
}

}  // namespace vismap
