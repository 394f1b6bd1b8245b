#include "freespace/octree_assembler.h"

#include <deque>

#include "base/require.h"

namespace vismap {
namespace {

constexpr int kLevels = kOctreeBlockLevels - kOctreeCubeLevels;

/// Moves bit i of a number of kLevels bits to bit 3 i.
uint64_t Spread3(uint64_t value) {
  uint64_t spread = 0;
  for (int bit = 0; bit < kLevels; ++bit) spread |= ((value >> bit) & 1) << (3 * bit);
  return spread;
}

class Assembler {
 public:
  Assembler(const OccupancyBox& outer, UnknownPolicy unknown)
      : outer_(outer), closed_(unknown == UnknownPolicy::kOccupied) {}

  /// The whole tree. A subtree does not count its own root, so the root is counted here.
  NodeWriter Run(std::span<const PlacedSubtree> parts) {
    size_t size = 0;
    for (const PlacedSubtree& part : parts) size += part.subtree->bytes.size();
    writer_.ReserveBytes(size + size / 8);
    const NodeState root = Emit(OctreeCube::Everything(), kLevels, parts);
    Require(root == NodeState::kUnknown || root == NodeState::kInner,
            "no map fills the whole key space of OctoMap");
    if (root == NodeState::kInner) writer_.CountRoot();
    return std::move(writer_);
  }

 private:
  NodeState Emit(const OctreeCube& cube, int level, std::span<const PlacedSubtree> parts) {
    if (parts.empty() && !closed_) return NodeState::kUnknown;
    if (Disjoint(cube, outer_)) return NodeState::kUnknown;
    if (parts.empty() && Inside(cube, outer_)) return NodeState::kOccupied;
    if (level == 0) return writer_.Append(parts.empty() ? Empty(cube) : *parts[0].subtree);
    const size_t start = writer_.Reserve();
    uint32_t code = 0;
    const int shift = 3 * (level - 1);
    for (int child = 0; child < 8; ++child) {
      size_t count = 0;
      while (count < parts.size() &&
             ((parts[count].order >> shift) & 7) == static_cast<uint64_t>(child)) {
        ++count;
      }
      const NodeState state = Emit(cube.Child(child), level - 1, parts.first(count));
      code |= NodeWriter::Code(state, child);
      parts = parts.subspan(count);
    }
    return writer_.Finish(start, code);
  }

  /// The subtree of an unknown cube at a side of the bounds. Cubes that the bounds cut in the same
  /// way have the same subtree.
  const Subtree& Empty(const OctreeCube& cube) {
    const OccupancyBox part = Intersect(cube.Box(), outer_);
    const auto from_corner = [&](VoxelIndex cell) {
      return VoxelIndex{cell.x - cube.min.x, cell.y - cube.min.y, cell.z - cube.min.z};
    };
    const OccupancyBox shape{from_corner(part.min), from_corner(part.max)};
    for (const auto& [known_shape, subtree] : empty_) {
      if (known_shape == shape) return subtree;
    }
    const Subtree subtree = EncodeSubtree(cube, nullptr, {part, part}, UnknownPolicy::kOccupied);
    return empty_.emplace_back(shape, subtree).second;
  }

  OccupancyBox outer_;
  bool closed_;
  NodeWriter writer_;
  std::deque<std::pair<OccupancyBox, Subtree>> empty_;  // by shape of the cut, at most 27
};

}  // namespace

uint64_t OctreeOrder(const OctreeCube& cube) {
  const auto place = [](int32_t min) {
    return Spread3(static_cast<uint64_t>((min + kOctreeCellOffset) / kOctreeCubeSide));
  };
  return place(cube.min.x) | place(cube.min.y) << 1 | place(cube.min.z) << 2;
}

NodeWriter AssembleOctree(std::span<const PlacedSubtree> parts, const OccupancyBox& outer,
                          UnknownPolicy unknown) {
  return Assembler(outer, unknown).Run(parts);
}

}  // namespace vismap
