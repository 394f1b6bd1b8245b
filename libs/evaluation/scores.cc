#include "evaluation/scores.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/require.h"

namespace vismap {
namespace {

// The group of a vertex: (0, instance), or (1, segment) if it has no instance.
std::pair<int, uint32_t> GroupOf(const MeshVertex& vertex) {
  if (vertex.instance != InstanceId::kNone) return {0, Raw(vertex.instance)};
  return {1, Raw(vertex.segment)};
}

// Whether a whole block is in true free space. Then its cells, as those of most blocks, need not be
// checked one by one.
bool IsFarFromSurface(const OccupancyMap& map, BlockIndex index, const TrueDistance& truth) {
  const double side = kBlockSide * map.cell_size();
  const Eigen::Vector3d center = (Eigen::Vector3d(index.x, index.y, index.z).array() + 0.5) * side;
  return truth(center) > 0.5 * std::sqrt(3.0) * side;
}

}  // namespace

GeometryScore ScoreGeometry(const Mesh& mesh, const TrueDistance& truth) {
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

std::map<uint16_t, ObjectScore> ScoreObjects(const Mesh& mesh,
                                             const std::vector<uint16_t>& truth_of) {
  Require(truth_of.size() == mesh.vertices.size(), "one true object per vertex");
  using Group = std::pair<int, uint32_t>;
  std::map<Group, int64_t> group_sizes;
  std::map<uint16_t, std::map<Group, int64_t>> overlaps;
  std::map<Group, ClassId> classes;
  for (size_t i = 0; i < truth_of.size(); ++i) {
    const Group group = GroupOf(mesh.vertices[i]);
    if (truth_of[i] != 0) ++overlaps[truth_of[i]][group];
    ++group_sizes[group];
    classes[group] = mesh.vertices[i].class_id;
  }
  std::map<uint16_t, ObjectScore> scores;
  for (const auto& [object, groups] : overlaps) {
    ObjectScore& score = scores[object];
    for (const auto& entry : groups) score.vertices += entry.second;
    for (const auto& [group, common] : groups) {
      if (group == Group{1, 0}) continue;  // surface without a segment
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

FreeSpaceScore ScoreFreeSpace(const OccupancyMap& map, const TrueDistance& truth, double margin) {
  FreeSpaceScore score;
  for (const BlockIndex& index : map.SortedIndices()) {
    const BlockOccupancy& block = map.At(index);
    if (block.is(CellState::kFree) && IsFarFromSurface(map, index, truth)) {
      score.free_cells += kBlockVoxels;
      continue;
    }
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const CellState state = block.At(offset);
      if (state == CellState::kUnknown) continue;
      const Eigen::Vector3d cell(index.x * kBlockSide + offset % kBlockSide,
                                 index.y * kBlockSide + offset / kBlockSide % kBlockSide,
                                 index.z * kBlockSide + offset / (kBlockSide * kBlockSide));
      const double distance = truth((cell.array() + 0.5) * map.cell_size());
      ++(state == CellState::kFree ? score.free_cells : score.occupied_cells);
      if (state == CellState::kFree && distance < -margin) ++score.free_but_solid;
      if (state == CellState::kFree) score.deepest_free = std::max(score.deepest_free, -distance);
      if (state == CellState::kOccupied && distance > margin) ++score.occupied_but_free;
    }
  }
  return score;
}

}  // namespace vismap
