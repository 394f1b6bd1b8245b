#include "support/naive/vertex_look.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "map/surface_reader.h"
#include "support/naive/mesh_block.h"
#include "support/naive/voxel_access.h"

namespace vismap::naive {
namespace {

/// Calls read(voxels, offset) if the voxel is in a block near a surface.
template <typename Read>
void WithVoxel(const SemanticMap& map, VoxelIndex voxel, const Read& read) {
  const Block* block = map.voxels.Find(BlockOf(voxel));
  if (block == nullptr || !block->surface) return;
  SurfaceReader reader;
  read(*reader.Read(*block), OffsetInBlock(voxel));
}

/// The key with the largest value; of several the lowest.
template <typename Key, typename Value>
Key KeyOfMost(const std::map<Key, Value>& values) {
  const auto most =
      std::max_element(values.begin(), values.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == values.end() ? Key{} : most->first;
}

SegmentLabel LabelOfVoxel(const SemanticMap& map, VoxelIndex voxel) {
  std::map<SegmentLabel, int> votes;
  WithVoxel(map, voxel, [&](const SurfaceVoxels& voxels, int offset) {
    for (const LabelVote& vote : ReadVotes(voxels, offset))
      votes[map.labels.Canonical(vote.label)] += vote.votes;
  });
  return KeyOfMost(votes);
}

/// Axes along which two voxels differ, and whether by a step at most.
struct Offset {
  int axes = 0;
  bool adjacent = true;
};
Offset OffsetOf(VoxelIndex a, VoxelIndex b) {
  Offset offset;
  for (const int step : {std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)}) {
    offset.axes += step > 0 ? 1 : 0;
    offset.adjacent = offset.adjacent && step <= 1;
  }
  return offset;
}

VoxelIndex Moved(VoxelIndex voxel, int axis, int steps) {
  int32_t* coordinates[] = {&voxel.x, &voxel.y, &voxel.z};
  *coordinates[axis] += steps;
  return voxel;
}

/// Gradient of the distance at an observed voxel [steps per voxel].
Eigen::Vector3f Gradient(VoxelIndex voxel, const VoxelMap& map, const MeshingOptions& options) {
  Eigen::Vector3f gradient;
  const auto here = SeenDistance(map, voxel, options);
  for (int axis = 0; axis < 3; ++axis) {
    const auto below = SeenDistance(map, Moved(voxel, axis, -1), options);
    const auto above = SeenDistance(map, Moved(voxel, axis, 1), options);
    const int rise = above.value_or(here.value()) - below.value_or(here.value());
    gradient[axis] = static_cast<float>(rise) * (below && above ? 0.5F : 1.0F);
  }
  return gradient;
}

/// Of the voxels next to an end, which differ from it along so many axes at most.
SegmentLabel MostFrequentBeside(const VertexEdge& edge, const SemanticMap& map, int most_axes) {
  std::map<SegmentLabel, int> frequency;
  const auto [low, high] = std::pair(edge.lower, edge.upper);
  for (int z = low.z - 1; z <= high.z + 1; ++z) {
    for (int y = low.y - 1; y <= high.y + 1; ++y) {
      for (int x = low.x - 1; x <= high.x + 1; ++x) {
        const Offset a = OffsetOf({x, y, z}, low), b = OffsetOf({x, y, z}, high);
        const bool beside =
            (a.adjacent && a.axes <= most_axes) || (b.adjacent && b.axes <= most_axes);
        const SegmentLabel label = LabelOfVoxel(map, {x, y, z});
        if (beside && label != SegmentLabel::kNone) ++frequency[label];
      }
    }
  }
  return KeyOfMost(frequency);
}

}  // namespace

VertexEdge EdgeOf(const MeshVertex& vertex, const SemanticMap& map) {
  VertexEdge edge;
  const Eigen::Vector3d at =
      vertex.position_W.cast<double>() / map.voxels.voxel_size() - Eigen::Vector3d::Constant(0.5);
  const Eigen::Vector3i nearest = at.array().round().cast<int>();
  int axis = 0;
  (at - nearest.cast<double>()).cwiseAbs().maxCoeff(&axis);
  Eigen::Vector3i low = nearest;
  low[axis] = static_cast<int>(std::floor(at[axis]));
  const Eigen::Vector3i high = low + Eigen::Vector3i::Unit(axis);
  edge.lower = {low.x(), low.y(), low.z()};
  edge.upper = {high.x(), high.y(), high.z()};
  // As exact as it was computed: a rounded position would do for the place, but not for a colour.
  const auto distance = [&](VoxelIndex voxel) {
    float steps = kTruncationSteps;  // of free blocks
    WithVoxel(map, voxel, [&](const SurfaceVoxels& voxels, int offset) {
      steps = ReadVoxel(voxels, offset).distance;
    });
    return steps;
  };
  const float from = distance(edge.lower), to = distance(edge.upper);
  edge.t = std::clamp(from / (from - to), 0.01F, 0.99F);
  return edge;
}

Rgb8 ColorAt(const VertexEdge& edge, const SemanticMap& map) {
  const auto color = [&](VoxelIndex voxel) {
    std::optional<Rgb8> found;
    WithVoxel(map, voxel, [&](const SurfaceVoxels& voxels, int offset) {
      found = ReadVoxel(voxels, offset).color;
    });
    return found;
  };
  const std::optional<Rgb8> lower = color(edge.lower), upper = color(edge.upper);
  if (!lower || !upper) return lower ? *lower : upper.value_or(Rgb8{});
  const int share = static_cast<int>(edge.t * 256 + 0.5F);
  const auto mix = [share](int a, int b) {
    return static_cast<uint8_t>((a * (256 - share) + b * share + 128) / 256);
  };
  return {mix(lower->r, upper->r), mix(lower->g, upper->g), mix(lower->b, upper->b)};
}

uint8_t SeenAt(const VertexEdge& edge, const SemanticMap& map) {
  const auto count = [&](VoxelIndex voxel) {
    uint8_t frames = 0;
    WithVoxel(map, voxel, [&](const SurfaceVoxels& voxels, int offset) {
      frames = voxels.observations[static_cast<size_t>(offset)];
    });
    return frames;
  };
  const bool lower_first = edge.t <= 0.5F;
  const uint8_t nearer = count(lower_first ? edge.lower : edge.upper);
  return nearer != 0 ? nearer : count(lower_first ? edge.upper : edge.lower);
}

Eigen::Vector3f NormalAt(const VertexEdge& edge, const SemanticMap& map,
                         const MeshingOptions& options) {
  const Eigen::Vector3f g = Gradient(edge.lower, map.voxels, options) * (1 - edge.t) +
                            Gradient(edge.upper, map.voxels, options) * edge.t;
  const float length = std::sqrt(g.x() * g.x() + (g.y() * g.y() + g.z() * g.z()));
  if (length > 1) return {g.x() / length, g.y() / length, g.z() / length};
  const Eigen::Vector3f along(static_cast<float>(edge.upper.x - edge.lower.x),
                              static_cast<float>(edge.upper.y - edge.lower.y),
                              static_cast<float>(edge.upper.z - edge.lower.z));
  const bool lower_is_behind = SeenDistance(map.voxels, edge.lower, options).value() < 0;
  return lower_is_behind ? along : Eigen::Vector3f(-along);
}

SegmentLabel LabelAtEnds(const VertexEdge& edge, const SemanticMap& map) {
  const bool lower_first = edge.t <= 0.5F;
  const SegmentLabel label = LabelOfVoxel(map, lower_first ? edge.lower : edge.upper);
  return label != SegmentLabel::kNone ? label
                                      : LabelOfVoxel(map, lower_first ? edge.upper : edge.lower);
}

SegmentLabel LabelAt(const VertexEdge& edge, const SemanticMap& map) {
  SegmentLabel label = LabelAtEnds(edge, map);
  for (const int most_axes : {1, 3}) {
    if (label == SegmentLabel::kNone) label = MostFrequentBeside(edge, map, most_axes);
  }
  return label;
}

}  // namespace vismap::naive
