#pragma once

#include <map>
#include <optional>
#include <span>

#include "evaluation/matches.h"

namespace vismap {

/// Panoptic quality (Kirillov 2019) of one class, counted on ground-truth points. Pairs with IoU >
/// 0.5 are matches. Points on void, or on objects that are too small, do not count in the union,
/// and a prediction with more than half of its points on them is not a false positive.
struct PanopticScore {
  int true_positives = 0, false_positives = 0, false_negatives = 0;
  double sum_iou = 0;  ///< of the matches

  std::optional<double> sq() const;  ///< mean IoU of the matches; none without matches
  std::optional<double> rq() const;  ///< F1 score; none without objects and predictions
  std::optional<double> pq() const;  ///< sq * rq; 0 without matches; none like rq
};

/// The score of one class. Objects and predictions with fewer points than `min_vertices` are left
/// out.
PanopticScore ScorePanoptic(const InstanceMatches& matches, ClassId class_id, int64_t min_vertices);

}  // namespace vismap
