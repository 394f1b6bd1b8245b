#include "meshing/surface_vertex.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace vismap {
namespace {

using Voxel = Eigen::Vector3i;

// Central difference in raw steps per voxel; one-sided at the rim of what was seen.
float Slope(const CellGrid& grid, const Voxel& at, int axis) {
  const Voxel step = Voxel::Unit(axis);
  const Voxel low = at - step, high = at + step;
  const bool has_low = grid.Observed(low.x(), low.y(), low.z());
  const bool has_high = grid.Observed(high.x(), high.y(), high.z());
  const float here = grid.Distance(at.x(), at.y(), at.z());
  const float below = has_low ? grid.Distance(low.x(), low.y(), low.z()) : here;
  const float above = has_high ? grid.Distance(high.x(), high.y(), high.z()) : here;
  return (above - below) * (has_low && has_high ? 0.5F : 1.0F);
}

Eigen::Vector3f Gradient(const CellGrid& grid, const Voxel& at) {
  return {Slope(grid, at, 0), Slope(grid, at, 1), Slope(grid, at, 2)};
}

Eigen::Vector3f Normal(const CellGrid& grid, const Voxel& a, const Voxel& b, float t) {
  const Eigen::Vector3f gradient = Gradient(grid, a) * (1 - t) + Gradient(grid, b) * t;
  const float length = gradient.norm();
  if (length > 1) return gradient / length;
  // No slope to speak of: toward the end that lies in front of the surface.
  const Eigen::Vector3f along = (b - a).cast<float>();
  return grid.Distance(a.x(), a.y(), a.z()) < 0 ? along : Eigen::Vector3f(-along);
}

Rgb8 Blend(Rgb8 a, Rgb8 b, float t) {
  const auto mix = [t](uint8_t low, uint8_t high) {
    const float value = static_cast<float>(low) * (1 - t) + static_cast<float>(high) * t;
    return static_cast<uint8_t>(value + 0.5F);
  };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

Rgb8 Color(const CellGrid::Place& a, const CellGrid::Place& b, float t) {
  const auto color = [](const CellGrid::Place& place) {
    return place.voxels->color[static_cast<size_t>(place.offset)];
  };
  if (a.voxels != nullptr && b.voxels != nullptr) return Blend(color(a), color(b), t);
  if (a.voxels != nullptr) return color(a);
  return b.voxels != nullptr ? color(b) : Rgb8{};
}

SegmentLabel LabelAt(const CellGrid::Place& place, const LabelTable& labels) {
  if (place.voxels == nullptr || place.voxels->palette.empty()) return SegmentLabel::kNone;
  return VoxelLabel(*place.voxels, place.offset, labels);
}

// The most frequent label among the voxels around both ends.
SegmentLabel LabelAround(const CellGrid& grid, const Voxel& a, const Voxel& b,
                         const LabelTable& labels) {
  std::map<SegmentLabel, int> counts;
  const Voxel low = (a.array() - 1).max(CellGrid::kLow);
  const Voxel high = (b.array() + 1).min(CellGrid::kLow + CellGrid::kSide - 1);
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        const SegmentLabel label = LabelAt(grid.At(x, y, z), labels);
        if (label != SegmentLabel::kNone) ++counts[label];
      }
    }
  }
  SegmentLabel best = SegmentLabel::kNone;
  int most = 0;
  for (const auto& [label, count] : counts) {
    if (count > most) best = label;
    most = std::max(most, count);
  }
  return best;
}

}  // namespace

MeshVertex MakeSurfaceVertex(const CellGrid& grid, const LatticeEdge& edge, double voxel_size,
                             const LabelTable& labels) {
  const Voxel a(edge.x, edge.y, edge.z);
  const Voxel b = a + Voxel::Unit(edge.axis);
  const float from = grid.Distance(a.x(), a.y(), a.z());
  const float to = grid.Distance(b.x(), b.y(), b.z());
  const float t = std::clamp(from / (from - to), 0.01F, 0.99F);

  const BlockIndex block = grid.block();
  const Eigen::Vector3d corner =
      Eigen::Vector3d(block.x, block.y, block.z) * kBlockSide + a.cast<double>();
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(edge.axis) * static_cast<double>(t);

  MeshVertex vertex;
  vertex.position_W = (((corner.array() + 0.5).matrix() + along) * voxel_size).cast<float>();
  vertex.normal_W = Normal(grid, a, b, t);
  const CellGrid::Place at_a = grid.At(a.x(), a.y(), a.z());
  const CellGrid::Place at_b = grid.At(b.x(), b.y(), b.z());
  vertex.color = Color(at_a, at_b, t);
  vertex.segment = LabelAt(t <= 0.5F ? at_a : at_b, labels);
  if (vertex.segment == SegmentLabel::kNone) {
    vertex.segment = LabelAt(t <= 0.5F ? at_b : at_a, labels);
  }
  if (vertex.segment == SegmentLabel::kNone) vertex.segment = LabelAround(grid, a, b, labels);
  return vertex;
}

}  // namespace vismap
