#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "evaluation/matches.h"

namespace vismap {

/// The other common average precision: predictions ranked by score, each to the free object that it
/// overlaps most, interpolated (enveloped) precision over all points. Stricter than ScanNet's: what
/// lies on void is a false positive, too.
struct RankedApOptions {
  int64_t min_object_vertices = 60;      ///< smaller objects are left out
  int64_t min_prediction_vertices = 10;  ///< smaller predictions are left out
  /// Instances without a score are ranked by their points, before all those with one.
  std::map<InstanceId, double> scores;
};

/// Of one class and its aliases, at IoU > `overlap`; [0, 1]. None = it has no object here.
std::optional<double> ScoreRanked(const InstanceMatches& matches, const EvaluatedClass& known,
                                  double overlap, const RankedApOptions& options);

struct RankedAp {
  std::optional<double> ap50, ap;  ///< `ap` = mean over 0.5, 0.55 ... 0.95
};
RankedAp ScoreRanked(const InstanceMatches& matches, const EvaluatedClass& known,
                     const RankedApOptions& options);

}  // namespace vismap
