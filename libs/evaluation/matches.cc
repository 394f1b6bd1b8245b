#include "evaluation/matches.h"

#include <functional>
#include <set>
#include <utility>

namespace vismap {
namespace {

using Group = std::pair<int, uint32_t>;  // (0, instance) or (1, segment); (1, 0) = nobody's

Group GroupAt(const TransferredLabels& labels, size_t point, bool with_segments) {
  if (labels.instance[point] != InstanceId::kNone) return {0, Raw(labels.instance[point])};
  return {1, with_segments ? Raw(labels.segment[point]) : 0};
}

// The points of the groups, and of all objects that `wanted` takes.
InstanceMatches Count(const GroundTruth& truth, const std::vector<Group>& groups,
                      const std::function<bool(const TrueObject&)>& wanted) {
  const std::vector<int> objects = truth.ObjectOfPoints();
  InstanceMatches matches;
  std::map<Group, size_t> index_of_group;
  for (const Group& group : groups) {
    if (group != Group{1, 0}) index_of_group.emplace(group, 0);
  }
  for (auto& [group, index] : index_of_group) {
    index = matches.predictions.size();
    matches.predictions.emplace_back();
    if (group.first == 0) matches.predictions.back().instance = InstanceId{group.second};
  }
  std::vector<size_t> index_of_object(truth.objects.size(), 0);  // from 1; 0 = not among the truths
  const std::set<int> present(objects.begin(), objects.end());
  for (size_t i = 0; i < truth.objects.size(); ++i) {
    if (!present.contains(static_cast<int>(i)) || !wanted(truth.objects[i])) continue;
    matches.truths.push_back({truth.objects[i].class_id, 0, i});
    index_of_object[i] = matches.truths.size();
  }
  matches.common.resize(matches.truths.size());
  for (size_t point = 0; point < groups.size(); ++point) {
    const size_t object =
        objects[point] < 0 ? 0 : index_of_object[static_cast<size_t>(objects[point])];
    if (object != 0) ++matches.truths[object - 1].vertices;
    if (groups[point] == Group{1, 0}) continue;
    const size_t group = index_of_group.at(groups[point]);
    ++matches.predictions[group].vertices;
    ++(object == 0 ? matches.predictions[group].on_void : matches.common[object - 1][group]);
  }
  return matches;
}

std::vector<Group> Groups(const TransferredLabels& labels, bool with_segments) {
  std::vector<Group> groups;
  groups.reserve(labels.instance.size());
  for (size_t i = 0; i < labels.instance.size(); ++i)
    groups.push_back(GroupAt(labels, i, with_segments));
  return groups;
}

}  // namespace

InstanceMatches MatchInstances(const GroundTruth& truth, const TransferredLabels& labels,
                               std::span<const EvaluatedClass> classes) {
  std::set<ClassId> wanted;
  for (const EvaluatedClass& known : classes) wanted.insert(known.class_id);
  InstanceMatches matches = Count(truth, Groups(labels, false), [&](const TrueObject& object) {
    return !object.is_structure && wanted.contains(object.class_id);
  });
  std::map<InstanceId, std::map<ClassId, int64_t>> class_counts;
  for (size_t i = 0; i < labels.instance.size(); ++i)
    ++class_counts[labels.instance[i]][labels.class_id[i]];
  for (PredictedInstance& prediction : matches.predictions) {
    int64_t most = 0;
    for (const auto& [class_id, count] : class_counts[prediction.instance]) {
      if (count <= most) continue;
      most = count;
      prediction.class_id = class_id;
    }
  }
  return matches;
}

InstanceMatches MatchGroups(const GroundTruth& truth, const TransferredLabels& labels) {
  InstanceMatches matches = Count(truth, Groups(labels, true),
                                  [](const TrueObject& object) { return !object.is_structure; });
  for (TruthInstance& object : matches.truths) object.class_id = ClassId::kUnknown;
  return matches;
}

}  // namespace vismap
