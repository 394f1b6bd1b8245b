#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "evaluation/matches.h"

namespace vismap {

/// The usual average precision: predictions are ranked by score, each is matched
/// with the unmatched object that it overlaps most, and the precision is interpolated
/// (non-increasing envelope over all points). It is stricter than ScanNet's, because a prediction
/// on void is a false positive, too.
struct RankedApOptions {
  int64_t min_object_vertices = 60;      ///< smaller objects are left out
  int64_t min_prediction_vertices = 10;  ///< smaller predictions are left out
  /// Scores of the instances. An instance without a score is ranked by its number of points, hence
  /// before all instances with a score in [0, 1].
  std::map<InstanceId, double> scores;
};

/// The AP [0, 1] of one class and its aliases at IoU > `overlap`. None if the class has no object.
std::optional<double> ScoreRanked(const InstanceMatches& matches, const EvaluatedClass& known,
                                  double overlap, const RankedApOptions& options);

/// The AP at IoU > 0.5, and its mean over the thresholds 0.5, 0.55, ..., 0.95.
struct RankedAp {
  std::optional<double> ap50, ap;
};
RankedAp ScoreRanked(const InstanceMatches& matches, const EvaluatedClass& known,
                     const RankedApOptions& options);

}  // namespace vismap
