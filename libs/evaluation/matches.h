#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "evaluation/class_list.h"
#include "evaluation/transfer.h"

namespace vismap {

/// A true object as a set of ground-truth points.
struct TruthInstance {
  ClassId class_id = ClassId::kUnknown;
  int64_t vertices = 0;
  size_t object = 0;  ///< index in GroundTruth::objects
};

/// An object of the map as a set of ground-truth points.
struct PredictedInstance {
  ClassId class_id = ClassId::kUnknown;
  int64_t vertices = 0;
  int64_t on_void = 0;  ///< of them, those on no TruthInstance
  InstanceId instance = InstanceId::kNone;
};

/// How the objects of a truth and of a map overlap: all that metrics of objects need.
struct InstanceMatches {
  std::vector<TruthInstance> truths;              ///< with at least one point
  std::vector<PredictedInstance> predictions;     ///< ascending by instance
  std::vector<std::map<size_t, int64_t>> common;  ///< [truth][prediction] = points in both, > 0

  int64_t Common(size_t truth, size_t prediction) const {
    const auto found = common[truth].find(prediction);
    return found == common[truth].end() ? 0 : found->second;
  }
  /// Intersection over union of the two sets of points.
  double Iou(size_t truth, size_t prediction) const {
    const auto both = static_cast<double>(Common(truth, prediction));
    return both / (static_cast<double>(truths[truth].vertices) +
                   static_cast<double>(predictions[prediction].vertices) - both);
  }
};

/// Objects of the given classes against the map's instances. All else is void: unlabelled surface,
/// structure, objects of other classes. A prediction's class is the most frequent one of its points
/// (the lower one of two).
InstanceMatches MatchInstances(const GroundTruth& truth, const TransferredLabels& labels,
                               std::span<const EvaluatedClass> classes);

/// All objects that are no structure, of any class, against the map's groups: its instances, then
/// the segments of what is in no instance. All classes are kUnknown here.
InstanceMatches MatchGroups(const GroundTruth& truth, const TransferredLabels& labels);

}  // namespace vismap
