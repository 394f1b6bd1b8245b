#include "freespace/octree_nodes.h"

#include <algorithm>
#include <array>

namespace vismap {
namespace {

NodeState ToNode(CellState state) { return static_cast<NodeState>(state); }

/// The cells of a block that lie in the box, one bit each.
std::array<uint64_t, 8> CellsInside(const OctreeCube& block, const OccupancyBox& box) {
  const auto clip = [](int32_t low, int32_t min, int32_t max) {
    const auto end = [&](int32_t at) { return std::clamp(at - low, 0, kBlockSide); };
    return ((uint64_t{1} << end(max)) - 1) & ~((uint64_t{1} << end(min)) - 1);
  };
  const uint64_t columns = clip(block.min.x, box.min.x, box.max.x);
  const uint64_t rows = clip(block.min.y, box.min.y, box.max.y);
  const uint64_t layers = clip(block.min.z, box.min.z, box.max.z);
  uint64_t slab = 0;
  for (int y = 0; y < kBlockSide; ++y) slab |= ((rows >> y) & 1) * columns << (8 * y);
  std::array<uint64_t, 8> cells{};
  for (size_t z = 0; z < 8; ++z) cells[z] = ((layers >> z) & 1) * slab;
  return cells;
}

/// The bits of cells (2x, 2y, 2z) to (2x+1, 2y+1, 2z+1) of a plane, in OctoMap's order of children.
uint32_t Eight(const std::array<uint64_t, 8>& plane, int x, int y, int z) {
  uint32_t bits = 0;
  for (int layer = 0; layer < 2; ++layer) {
    const uint64_t slab = plane[static_cast<size_t>(2 * z + layer)] >> (16 * y + 2 * x);
    bits |= static_cast<uint32_t>((slab & 3) | ((slab >> 8) & 3) << 2) << (4 * layer);
  }
  return bits;
}

constexpr std::array<uint16_t, 256> kEveryOtherBit = [] {
  std::array<uint16_t, 256> table{};
  for (uint32_t value = 0; value < 256; ++value) {
    uint32_t spread = 0;
    for (uint32_t bit = 0; bit < 8; ++bit) spread |= ((value >> bit) & 1) << (2 * bit);
    table[value] = static_cast<uint16_t>(spread);
  }
  return table;
}();

/// The state that all 4 x 4 x 4 cells of a group have; kInner when they differ. `group`: one of the
/// eight of a block, in OctoMap's order.
NodeState StateOfGroup(const OccupancyPlanes& planes, int group) {
  const uint64_t cells = uint64_t{0x0f0f0f0f} << (4 * (group & 1) + 32 * ((group >> 1) & 1));
  uint64_t all_free = cells, all_occupied = cells, any = 0;
  for (int layer = 0; layer < 4; ++layer) {
    const auto z = static_cast<size_t>(4 * (group >> 2) + layer);
    all_free &= planes.free[z];
    all_occupied &= planes.occupied[z];
    any |= planes.free[z] | planes.occupied[z];
  }
  if (all_free == cells) return NodeState::kFree;
  if (all_occupied == cells) return NodeState::kOccupied;
  return (any & cells) == 0 ? NodeState::kUnknown : NodeState::kInner;
}

class SubtreeEncoder {
 public:
  SubtreeEncoder(const OccupancyMap* leaves, const OctreeExtent& extent, UnknownPolicy unknown)
      : leaves_(leaves), extent_(extent), closed_(unknown == UnknownPolicy::kOccupied) {}

  NodeState EmitNode(const OctreeCube& cube) {
    if (Disjoint(cube, closed_ ? extent_.outer : extent_.box)) return NodeState::kUnknown;
    if (closed_ && Disjoint(cube, extent_.box) && Inside(cube, extent_.outer))
      return NodeState::kOccupied;
    if (cube.size == kBlockSide) return EmitBlock(cube);
    const size_t start = writer_.Reserve();
    uint32_t code = 0;
    for (int child = 0; child < 8; ++child) {
      code |= NodeWriter::Code(EmitNode(cube.Child(child)), child);
    }
    return writer_.Finish(start, code);
  }

  const NodeWriter& writer() const { return writer_; }

 private:
  NodeState EmitBlock(const OctreeCube& cube) {
    static const BlockOccupancy kUnknown;
    const BlockOccupancy& block = leaves_ == nullptr ? kUnknown : leaves_->At(BlockOf(cube.min));
    if (!closed_ && block.is(CellState::kUnknown)) return NodeState::kUnknown;
    if (block.is_uniform() && Inside(cube, extent_.box)) {
      return block.is(CellState::kUnknown) ? NodeState::kOccupied : ToNode(block.uniform_state());
    }
    OccupancyPlanes planes = block.Planes();
    const std::array<uint64_t, 8> cells = CellsInside(cube, extent_.box);
    const std::array<uint64_t, 8> outer = CellsInside(cube, extent_.outer);
    for (size_t z = 0; z < 8; ++z) {
      planes.free[z] &= cells[z];
      planes.occupied[z] &= cells[z];
      if (closed_) planes.occupied[z] |= outer[z] & ~planes.free[z];
    }
    return EmitGroups(planes);
  }

  /// Writes the two inner levels of a block, and its cells.
  NodeState EmitGroups(const OccupancyPlanes& planes) {
    const size_t start = writer_.Reserve();
    uint32_t code = 0;
    for (int group = 0; group < 8; ++group) {
      NodeState state = StateOfGroup(planes, group);
      if (state == NodeState::kInner) state = EmitGroup(planes, group);
      code |= NodeWriter::Code(state, group);
    }
    return writer_.Finish(start, code);
  }

  NodeState EmitGroup(const OccupancyPlanes& planes, int group) {
    const size_t start = writer_.Reserve();
    uint32_t code = 0;
    for (int child = 0; child < 8; ++child) {
      const int x = 2 * (group & 1) + (child & 1);
      const int y = 2 * ((group >> 1) & 1) + ((child >> 1) & 1);
      const int z = 2 * (group >> 2) + (child >> 2);
      const uint32_t cells = kEveryOtherBit[Eight(planes.free, x, y, z)] |
                             static_cast<uint32_t>(kEveryOtherBit[Eight(planes.occupied, x, y, z)])
                                 << 1;
      const size_t cell_start = writer_.Reserve();
      code |= NodeWriter::Code(writer_.Finish(cell_start, cells), child);
    }
    return writer_.Finish(start, code);
  }

  const OccupancyMap* leaves_;
  OctreeExtent extent_;
  bool closed_;
  NodeWriter writer_;
};

}  // namespace

NodeState NodeWriter::Finish(size_t start, uint32_t code) {
  constexpr uint32_t kAllFree = 0x5555;
  constexpr uint32_t kAllOccupied = 0xaaaa;
  if (code == 0 || code == kAllFree || code == kAllOccupied) {
    bytes_.resize(start);
    if (code == 0) return NodeState::kUnknown;
    return code == kAllFree ? NodeState::kFree : NodeState::kOccupied;
  }
  bytes_[start] = static_cast<uint8_t>(code & 0xff);
  bytes_[start + 1] = static_cast<uint8_t>(code >> 8);
  for (int child = 0; child < 8; ++child) nodes_ += ((code >> (2 * child)) & 3) != 0;
  return NodeState::kInner;
}

Subtree EncodeSubtree(const OctreeCube& cube, const OccupancyMap* leaves,
                      const OctreeExtent& extent, UnknownPolicy unknown) {
  SubtreeEncoder encoder(leaves, extent, unknown);
  const NodeState state = encoder.EmitNode(cube);
  // Copied, since a copy has no spare capacity and thousands of subtrees are kept.
  return {state, encoder.writer().nodes(), encoder.writer().bytes()};
}

}  // namespace vismap
