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
  int64_t on_void = 0;  ///< its points on no TruthInstance
  InstanceId instance = InstanceId::kNone;
};

/// The overlaps between the objects of a ground truth and of a map. All metrics of objects are
/// computed from them.
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

/// Compares the true objects of the given classes with the instances of the map. All other points
/// are void: unlabelled surface, structure, objects of other classes. The class of a prediction is
/// the most frequent one of its points, ties to the lower id.
InstanceMatches MatchInstances(const GroundTruth& truth, const TransferredLabels& labels,
                               std::span<const EvaluatedClass> classes);

/// Compares all true objects except structure, of any class, with the groups of the map: its
/// instances, then the segments of points without an instance. All classes are set to kUnknown.
InstanceMatches MatchGroups(const GroundTruth& truth, const TransferredLabels& labels);

/// The same groups compared with all true objects, structure among them. Only points without a true
/// object are void.
InstanceMatches MatchGroupsAndStructure(const GroundTruth& truth, const TransferredLabels& labels);

}  // namespace vismap
