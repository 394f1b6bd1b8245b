#include "evaluation/matches.h"

#include <functional>
#include <set>
#include <utility>

namespace vismap {
namespace {

// A group of points: (0, instance), or (1, segment) of points without an instance.
using Group = std::pair<int, uint32_t>;
constexpr Group kNoGroup{1, 0};  // points without instance and segment

Group GroupAt(const TransferredLabels& labels, size_t point, bool with_segments) {
  if (labels.instance[point] != InstanceId::kNone) return {0, Raw(labels.instance[point])};
  return {1, with_segments ? Raw(labels.segment[point]) : 0};
}

// Adds one prediction per group, in ascending order. Returns the index of each group's prediction.
std::map<Group, size_t> AddGroups(const std::vector<Group>& groups, InstanceMatches* matches) {
  std::map<Group, size_t> index_of;
  for (const Group& group : groups) {
    if (group != kNoGroup) index_of.emplace(group, 0);
  }
  for (auto& [group, index] : index_of) {
    index = matches->predictions.size();
    matches->predictions.emplace_back();
    if (group.first == 0) matches->predictions.back().instance = InstanceId{group.second};
  }
  return index_of;
}

// Adds one truth per object that has points and that `wanted` accepts. Returns the index of the
// truth for the index of each such object.
std::map<int, size_t> AddObjects(const GroundTruth& truth, const std::vector<int>& object_of_points,
                                 const std::function<bool(const TrueObject&)>& wanted,
                                 InstanceMatches* matches) {
  std::map<int, size_t> index_of;
  for (const int i : std::set<int>(object_of_points.begin(), object_of_points.end())) {
    if (i < 0 || !wanted(truth.objects[static_cast<size_t>(i)])) continue;
    index_of[i] = matches->truths.size();
    matches->truths.push_back(
        {truth.objects[static_cast<size_t>(i)].class_id, 0, static_cast<size_t>(i)});
  }
  matches->common.resize(matches->truths.size());
  return index_of;
}

// Counts the points of the groups and of the objects that `wanted` accepts, and those they share.
InstanceMatches CountOverlaps(const GroundTruth& truth, const std::vector<Group>& groups,
                              const std::function<bool(const TrueObject&)>& wanted) {
  const std::vector<int> objects = truth.ObjectOfPoints();
  InstanceMatches matches;
  const std::map<Group, size_t> index_of_group = AddGroups(groups, &matches);
  const std::map<int, size_t> index_of_object = AddObjects(truth, objects, wanted, &matches);
  for (size_t point = 0; point < groups.size(); ++point) {
    const auto object = index_of_object.find(objects[point]);
    const bool on_void = object == index_of_object.end();
    if (!on_void) ++matches.truths[object->second].vertices;
    if (groups[point] == kNoGroup) continue;
    const size_t group = index_of_group.at(groups[point]);
    ++matches.predictions[group].vertices;
    ++(on_void ? matches.predictions[group].on_void : matches.common[object->second][group]);
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

// Compares the true objects that `wanted` accepts, of any class, with all groups.
InstanceMatches MatchAllGroups(const GroundTruth& truth, const TransferredLabels& labels,
                               const std::function<bool(const TrueObject&)>& wanted) {
  InstanceMatches matches = CountOverlaps(truth, Groups(labels, true), wanted);
  for (TruthInstance& object : matches.truths) object.class_id = ClassId::kUnknown;
  return matches;
}

}  // namespace

InstanceMatches MatchInstances(const GroundTruth& truth, const TransferredLabels& labels,
                               std::span<const EvaluatedClass> classes) {
  std::set<ClassId> wanted;
  for (const EvaluatedClass& known : classes) wanted.insert(known.class_id);
  InstanceMatches matches =
      CountOverlaps(truth, Groups(labels, false), [&](const TrueObject& object) {
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
  return MatchAllGroups(truth, labels,
                        [](const TrueObject& object) { return !object.is_structure; });
}

InstanceMatches MatchGroupsAndStructure(const GroundTruth& truth, const TransferredLabels& labels) {
  return MatchAllGroups(truth, labels, [](const TrueObject&) { return true; });
}

}  // namespace vismap
