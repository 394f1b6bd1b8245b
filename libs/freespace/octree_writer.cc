#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "base/file.h"
#include "base/require.h"
#include "freespace/coarsen.h"
#include "freespace/octree.h"

namespace vismap {
namespace {

// OctoMap's key space: 2^16 leaves along each axis, the origin in the middle. One of our blocks of
// 8^3 leaves is a node three levels above the leaves.
constexpr int kBlockLevels = 13;
constexpr int32_t kBlockOffset = 1 << (kBlockLevels - 1);
constexpr int32_t kCellOffset = kBlockSide * kBlockOffset;

enum class NodeState : uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2, kInner = 3 };

NodeState ToNode(CellState state) { return static_cast<NodeState>(state); }

/// Bits of a 13-bit number, three apart.
uint64_t Spread3(uint64_t value) {
  uint64_t spread = 0;
  for (int bit = 0; bit < kBlockLevels; ++bit) spread |= ((value >> bit) & 1) << (3 * bit);
  return spread;
}

/// Place of a block in depth-first order.
uint64_t MortonOf(BlockIndex block) {
  return Spread3(static_cast<uint64_t>(block.x + kBlockOffset)) |
         Spread3(static_cast<uint64_t>(block.y + kBlockOffset)) << 1 |
         Spread3(static_cast<uint64_t>(block.z + kBlockOffset)) << 2;
}

struct Item {
  uint64_t morton = 0;
  const BlockOccupancy* block = nullptr;
};

/// A cube of cells: an octree node.
struct Cube {
  VoxelIndex min;
  int32_t size = 0;

  Cube Child(int child) const {
    const int32_t half = size / 2;
    return {{min.x + (child & 1) * half, min.y + ((child >> 1) & 1) * half,
             min.z + ((child >> 2) & 1) * half},
            half};
  }
};

bool Disjoint(const Cube& cube, const CellBox& box) {
  const auto apart = [&](int32_t low, int32_t min, int32_t max) {
    return low >= max || low + cube.size <= min;
  };
  return apart(cube.min.x, box.min.x, box.max.x) || apart(cube.min.y, box.min.y, box.max.y) ||
         apart(cube.min.z, box.min.z, box.max.z);
}

bool Inside(const Cube& cube, const CellBox& box) {
  const auto within = [&](int32_t low, int32_t min, int32_t max) {
    return low >= min && low + cube.size <= max;
  };
  return within(cube.min.x, box.min.x, box.max.x) && within(cube.min.y, box.min.y, box.max.y) &&
         within(cube.min.z, box.min.z, box.max.z);
}

/// The cells of a block that lie in the box, one bit each.
std::array<uint64_t, 8> CellsInside(const Cube& block, const CellBox& box) {
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

/// Cells (2x, 2y, 2z) to (2x+1, 2y+1, 2z+1) of a plane as eight bits in OctoMap's order of
/// children.
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

/// Writes the nodes of a tree depth first, as OctoMap does: two bytes per inner node, two bits per
/// child, before the children's own nodes. A node whose children are all free, or all occupied,
/// becomes a leaf on the way back up, which is OctoMap's pruning.
class Emitter {
 public:
  Emitter(std::vector<Item> items, const CellBox& box, UnknownPolicy unknown)
      : items_(std::move(items)), box_(box), closed_(unknown == UnknownPolicy::kOccupied) {}

  void Run() {
    const Cube everything{{-kCellOffset, -kCellOffset, -kCellOffset}, 2 * kCellOffset};
    const NodeState root = EmitNode(everything, kBlockLevels, 0, items_.size());
    Require(root == NodeState::kUnknown || root == NodeState::kInner,
            "no map fills the whole key space of OctoMap");
    if (root == NodeState::kInner) ++nodes_;
  }

  const std::vector<uint8_t>& bytes() const { return bytes_; }
  int64_t nodes() const { return nodes_; }

 private:
  NodeState EmitNode(const Cube& cube, int level, size_t begin, size_t end) {
    if (Disjoint(cube, box_)) return NodeState::kUnknown;
    if (begin == end) return EmitEmpty(cube);
    if (level == 0) return EmitBlock(cube, *items_[begin].block);
    const size_t start = Reserve();
    uint32_t code = 0;
    const int shift = 3 * (level - 1);
    for (int child = 0; child < 8; ++child) {
      size_t split = begin;
      while (split < end && ((items_[split].morton >> shift) & 7) == static_cast<uint64_t>(child)) {
        ++split;
      }
      code |= Code(EmitNode(cube.Child(child), level - 1, begin, split), child);
      begin = split;
    }
    return Finish(start, code);
  }

  /// A node of which nothing is known.
  NodeState EmitEmpty(const Cube& cube) {
    if (!closed_ || Disjoint(cube, box_)) return NodeState::kUnknown;
    if (Inside(cube, box_)) return NodeState::kOccupied;
    const size_t start = Reserve();
    uint32_t code = 0;
    for (int child = 0; child < 8; ++child) code |= Code(EmitEmpty(cube.Child(child)), child);
    return Finish(start, code);
  }

  NodeState EmitBlock(const Cube& cube, const BlockOccupancy& block) {
    const bool inside = Inside(cube, box_);
    if (inside && block.is_uniform()) return ToNode(block.uniform_state());
    OccupancyPlanes planes = block.Planes();
    const std::array<uint64_t, 8> cells = CellsInside(cube, box_);
    for (size_t z = 0; z < 8; ++z) {
      planes.free[z] &= cells[z];
      planes.occupied[z] &= cells[z];
      if (closed_) planes.occupied[z] |= cells[z] & ~planes.free[z];
    }
    return EmitGroups(planes);
  }

  /// The two inner levels of a block, and its cells.
  NodeState EmitGroups(const OccupancyPlanes& planes) {
    const size_t start = Reserve();
    uint32_t code = 0;
    for (int group = 0; group < 8; ++group) {
      const size_t group_start = Reserve();
      uint32_t group_code = 0;
      for (int child = 0; child < 8; ++child) {
        const int x = 2 * (group & 1) + (child & 1);
        const int y = 2 * ((group >> 1) & 1) + ((child >> 1) & 1);
        const int z = 2 * (group >> 2) + (child >> 2);
        const uint32_t cells =
            kEveryOtherBit[Eight(planes.free, x, y, z)] |
            static_cast<uint32_t>(kEveryOtherBit[Eight(planes.occupied, x, y, z)]) << 1;
        const size_t cell_start = Reserve();
        group_code |= Code(Finish(cell_start, cells), child);
      }
      code |= Code(Finish(group_start, group_code), group);
    }
    return Finish(start, code);
  }

  static uint32_t Code(NodeState state, int child) {
    return static_cast<uint32_t>(state) << (2 * child);
  }

  size_t Reserve() {
    bytes_.resize(bytes_.size() + 2);
    return bytes_.size() - 2;
  }

  /// Fills in a node's two bytes, or takes them back when it needs none.
  NodeState Finish(size_t start, uint32_t code) {
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

  std::vector<Item> items_;
  CellBox box_;
  bool closed_;
  std::vector<uint8_t> bytes_;
  int64_t nodes_ = 0;
};

/// The shortest text that reads back as the same number.
std::string Shortest(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

Result<std::vector<Item>> DepthFirst(const OccupancyMap& leaves, double resolution) {
  std::vector<Item> items;
  items.reserve(leaves.size());
  for (const auto& [index, block] : leaves.table()) {
    const auto fits = [](int32_t i) { return i >= -kBlockOffset && i < kBlockOffset; };
    if (!fits(index.x) || !fits(index.y) || !fits(index.z)) {
      return Fail("octree: the map reaches beyond the " + Shortest(kCellOffset * resolution) +
                  " m around the origin that an octree with leaves of " + Shortest(resolution) +
                  " m can hold; use larger leaves");
    }
    items.push_back({MortonOf(index), &block});
  }
  std::sort(items.begin(), items.end(),
            [](const Item& a, const Item& b) { return a.morton < b.morton; });
  return items;
}

/// The cells whose centres lie in the box.
CellBox CellsOf(const Eigen::AlignedBox3d& bounds_W, double resolution) {
  const auto cell = [&](double at) {
    const double rounded = std::round(at / resolution);
    return static_cast<int32_t>(std::clamp(rounded, -double{kCellOffset}, double{kCellOffset}));
  };
  const Eigen::Vector3d& min = bounds_W.min();
  const Eigen::Vector3d& max = bounds_W.max();
  return {{cell(min.x()), cell(min.y()), cell(min.z())},
          {cell(max.x()), cell(max.y()), cell(max.z())}};
}

Eigen::AlignedBox3d MetersOf(const CellBox& box, double resolution) {
  return {Eigen::Vector3d(box.min.x, box.min.y, box.min.z) * resolution,
          Eigen::Vector3d(box.max.x, box.max.y, box.max.z) * resolution};
}

}  // namespace

Result<OctreeGrid> ChooseOctreeGrid(double voxel_size, double resolution) {
  constexpr double kDefaultResolution = 0.05;
  constexpr double kMinFactor = 2;
  constexpr double kMaxFactor = 64;
  const bool automatic = resolution == 0;
  const double wanted = automatic ? kDefaultResolution : resolution;
  const double ratio = wanted / voxel_size;
  const double whole = automatic ? std::ceil(ratio - 1e-6) : std::round(ratio);
  const double factor = std::clamp(whole, kMinFactor, kMaxFactor);
  // To a picometre, so that 7 voxels of 1 cm are 0.07 m and not 0.07000000000000001 m.
  const double nearest = std::round(factor * voxel_size * 1e12) / 1e12;
  if (automatic || std::abs(ratio - factor) < 1e-6) {
    return OctreeGrid{static_cast<int>(factor), nearest};
  }
  return Fail("octree resolution: expected 2 to 64 times the voxel size of " +
              Shortest(voxel_size) + " m, found " + Shortest(resolution) + " m; the nearest is " +
              Shortest(nearest) + " m");
}

Result<OctreeBytes> BuildOctree(const OccupancyMap& map, const OctreeOptions& options) {
  const Result<OctreeGrid> grid = ChooseOctreeGrid(map.cell_size(), options.resolution);
  if (!grid) return tl::unexpected(grid.error());
  if (!(options.free_fraction > 0 && options.free_fraction <= 1)) {
    return Fail("octree free_fraction: expected a number above 0 and at most 1, found " +
                Shortest(options.free_fraction));
  }
  const OccupancyMap leaves = Coarsen(map, {grid->factor, options.free_fraction});
  return EncodeOctree(leaves, grid->resolution, options.unknown, options.bounds_W);
}

Result<OctreeBytes> EncodeOctree(const OccupancyMap& leaves, double resolution,
                                 UnknownPolicy unknown,
                                 const std::optional<Eigen::AlignedBox3d>& bounds_W) {
  Result<std::vector<Item>> items = DepthFirst(leaves, resolution);
  if (!items) return tl::unexpected(items.error());
  std::optional<CellBox> box = leaves.KnownCells();
  if (bounds_W) box = CellsOf(*bounds_W, resolution);
  Emitter emitter(std::move(*items), box.value_or(CellBox{}), unknown);
  emitter.Run();

  OctreeBytes octree;
  octree.resolution = resolution;
  octree.nodes = emitter.nodes();
  octree.unknown = unknown;
  if (box) octree.bounds_W = MetersOf(*box, resolution);
  const std::string header =
      "# Octomap OcTree binary file\n"
      "# (feel free to add / change comments, but leave the first line as it is!)\n"
      "#\n"
      "id OcTree\nsize " +
      std::to_string(octree.nodes) + "\nres " + Shortest(resolution) + "\ndata\n";
  octree.bytes.assign(header.begin(), header.end());
  octree.bytes.insert(octree.bytes.end(), emitter.bytes().begin(), emitter.bytes().end());
  return octree;
}

Result<void> WriteOctree(const std::filesystem::path& path, const OctreeBytes& octree) {
  return WriteFileAtomically(path, octree.bytes);
}

}  // namespace vismap
