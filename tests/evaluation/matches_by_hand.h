#pragma once

#include <map>

#include "evaluation/matches.h"

namespace vismap {

constexpr ClassId kChair{62}, kTable{67};

/// Objects and predictions put together by how many points they share.
class MatchesByHand : public InstanceMatches {
 public:
  /// Returns its index.
  size_t Truth(ClassId class_id, int64_t vertices) {
    truths.push_back({class_id, vertices, truths.size()});
    common.emplace_back();
    return truths.size() - 1;
  }
  /// Instances 1, 2 ... `overlaps` = points on each truth; the rest of `vertices` is on void.
  void Prediction(ClassId class_id, int64_t vertices, const std::map<size_t, int64_t>& overlaps) {
    PredictedInstance prediction{class_id, vertices, vertices,
                                 InstanceId{static_cast<uint32_t>(predictions.size() + 1)}};
    for (const auto& [truth, count] : overlaps) {
      common[truth][predictions.size()] = count;
      prediction.on_void -= count;
    }
    predictions.push_back(prediction);
  }
  /// An object of this size and a prediction that is exactly it.
  void Perfect(ClassId class_id, int64_t vertices) {
    const size_t truth = Truth(class_id, vertices);
    Prediction(class_id, vertices, {{truth, vertices}});
  }
};

}  // namespace vismap
