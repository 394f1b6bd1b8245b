#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/require.h"
#include "evaluation/scores.h"
#include "meshing/mesh.h"

namespace vismap::testing_support {

/// Distances of the vertices of a mesh to the true surface [m], without sign.
struct GeometryScore {
  double mean = 0;
  double p95 = 0;
  int64_t vertices = 0;
};
inline GeometryScore ScoreGeometry(const Mesh& mesh, const TrueDistance& truth) {
  std::vector<double> distances(mesh.vertices.size());
  ParallelFor(distances.size(), 256, [&](size_t i) {
    distances[i] = std::abs(truth(mesh.vertices[i].position_W.cast<double>()));
  });
  GeometryScore score;
  score.vertices = static_cast<int64_t>(distances.size());
  if (distances.empty()) return score;
  double sum = 0;
  for (const double distance : distances) sum += distance;
  score.mean = sum / static_cast<double>(distances.size());
  std::sort(distances.begin(), distances.end());
  score.p95 = distances[(distances.size() - 1) * 95 / 100];
  return score;
}

/// One true object, judged by the vertices of the mesh that lie on it. A group is all vertices with
/// the same instance or, without one, with the same segment.
struct ObjectScore {
  double iou = 0;                           ///< of the group that overlaps the object best
  InstanceId instance = InstanceId::kNone;  ///< of that group; kNone = a discovered segment
  ClassId class_id = ClassId::kUnknown;     ///< of that group
  int fragments = 0;                        ///< groups that hold more than a tenth of the object
  int64_t vertices = 0;                     ///< that lie on the object
};

/// A group: (0, instance) or, without an instance, (1, segment).
using VertexGroup = std::pair<int, uint32_t>;
inline VertexGroup GroupOf(const MeshVertex& vertex) {
  if (vertex.instance != InstanceId::kNone) return {0, Raw(vertex.instance)};
  return {1, Raw(vertex.segment)};
}

/// `truth_of` = id of the true object that each vertex lies on; 0 = none. Ties go to the lower id.
inline std::map<uint16_t, ObjectScore> ScoreObjects(const Mesh& mesh,
                                                    const std::vector<uint16_t>& truth_of) {
  Require(truth_of.size() == mesh.vertices.size(), "one true object per vertex");
  std::map<VertexGroup, int64_t> group_sizes;
  std::map<uint16_t, std::map<VertexGroup, int64_t>> overlaps;
  std::map<VertexGroup, ClassId> classes;
  for (size_t i = 0; i < truth_of.size(); ++i) {
    const VertexGroup group = GroupOf(mesh.vertices[i]);
    if (truth_of[i] != 0) ++overlaps[truth_of[i]][group];
    ++group_sizes[group];
    classes[group] = mesh.vertices[i].class_id;
  }
  std::map<uint16_t, ObjectScore> scores;
  for (const auto& [object, groups] : overlaps) {
    ObjectScore& score = scores[object];
    for (const auto& entry : groups) score.vertices += entry.second;
    for (const auto& [group, common] : groups) {
      if (group == VertexGroup{1, 0}) continue;  // vertices without instance and segment
      if (common * 10 > score.vertices) ++score.fragments;
      const double iou = static_cast<double>(common) /
                         static_cast<double>(score.vertices + group_sizes[group] - common);
      if (iou <= score.iou) continue;
      score.iou = iou;
      score.instance = group.first == 0 ? static_cast<InstanceId>(group.second) : InstanceId::kNone;
      score.class_id = classes[group];
    }
  }
  return scores;
}

}  // namespace vismap::testing_support
