#include "exports/color_octree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "freespace/cell_overlaps.h"
#include "freespace/octree.h"
#include "freespace/shortest_text.h"
#include "map/surface_reader.h"
#include "objects/read_out.h"
#include "render/palette.h"

namespace vismap {
namespace {

constexpr int kDepth = 16;
constexpr int32_t kOrigin = 1 << (kDepth - 1);  // leaf 0 of the map among the keys of OctoMap
// Log odds: OctoMap's limits for what is certain.
constexpr float kOccupied = 3.5F, kFree = -2.0F;
constexpr Rgb8 kNoColor{255, 255, 255};  // as in a new ColorOcTreeNode

/// A leaf of the smallest size by its position in depth-first order.
struct ColoredLeaf {
  uint64_t order = 0;
  Rgb8 color;
};
using Leaves = std::span<const ColoredLeaf>;

uint64_t Spread3(uint32_t value) {
  uint64_t spread = 0;
  for (int bit = 0; bit < kDepth; ++bit) spread |= uint64_t{(value >> bit) & 1} << (3 * bit);
  return spread;
}

uint32_t Packed(const Rgb8& color) {
  return uint32_t{color.r} << 16 | uint32_t{color.g} << 8 | color.b;
}

/// One vote of a voxel for the colour of its leaf.
struct LeafVote {
  uint64_t order = 0;
  uint32_t color = 0;
  friend auto operator<=>(const LeafVote&, const LeafVote&) = default;
};

class VoteCollector {
 public:
  VoteCollector(const SemanticMap& map, int factor) : map_(map), factor_(factor) {
    for (const ShownLabel& shown : ShowLabels(map.labels)) {
      MeshVertex vertex;
      vertex.segment = shown.segment;
      vertex.instance = shown.instance;
      vertex.class_id = shown.class_id;
      colors_.push_back(Packed(VertexColor(vertex, Coloring::kClass)));
    }
  }

  std::vector<LeafVote> Collect() {
    for (const BlockIndex& index : map_.voxels.SortedIndices()) {
      const SurfaceVoxels* voxels = reader_.Read(*map_.voxels.Find(index));
      if (voxels != nullptr) AddBlock(index, *voxels);
      reader_.Trim();
    }
    std::sort(votes_.begin(), votes_.end());
    return std::move(votes_);
  }

 private:
  void AddBlock(BlockIndex index, const SurfaceVoxels& voxels) {
    for (int i = 0; i < kBlockVoxels; ++i) {
      const SegmentLabel label = voxels.Vote(i, 0).label;
      if (label == SegmentLabel::kNone || Raw(label) >= colors_.size()) continue;
      const std::array<int32_t, 3> leaf{LeafOf(index.x, i & 7), LeafOf(index.y, (i >> 3) & 7),
                                        LeafOf(index.z, i >> 6)};
      if (std::any_of(leaf.begin(), leaf.end(), [](int32_t key) { return key >> kDepth != 0; }))
        continue;
      uint64_t order = 0;
      for (size_t axis = 0; axis < 3; ++axis)
        order |= Spread3(static_cast<uint32_t>(leaf[axis])) << axis;
      votes_.push_back({order, colors_[Raw(label)]});
    }
  }

  int32_t LeafOf(int32_t block, int voxel) const {
    return FloorDivide(kBlockSide * block + voxel, factor_) + kOrigin;
  }

  const SemanticMap& map_;
  int factor_;
  std::vector<uint32_t> colors_;  // by label
  std::vector<LeafVote> votes_;
  SurfaceReader reader_;
};

/// The colour with most votes of each leaf, ascending; ties to the lower one.
std::vector<ColoredLeaf> ElectColors(const std::vector<LeafVote>& votes) {
  std::vector<ColoredLeaf> leaves;
  for (size_t begin = 0; begin < votes.size();) {
    size_t best = 0, end = begin;
    uint32_t color = 0;
    while (end < votes.size() && votes[end].order == votes[begin].order) {
      const auto same = std::upper_bound(votes.begin() + static_cast<std::ptrdiff_t>(end),
                                         votes.end(), votes[end]);
      const auto next = static_cast<size_t>(same - votes.begin());
      if (next - end > best) {
        best = next - end;
        color = votes[end].color;
      }
      end = next;
    }
    leaves.push_back({votes[begin].order,
                      {static_cast<uint8_t>(color >> 16), static_cast<uint8_t>(color >> 8),
                       static_cast<uint8_t>(color)}});
    begin = end;
  }
  return leaves;
}

/// Rewrites the nodes of a valid `.bt` stream as those of an `.ot` stream with colours.
class ColorWriter {
 public:
  explicit ColorWriter(std::span<const uint8_t> nodes) : nodes_(nodes) {}

  void Write(Leaves leaves) {
    if (!nodes_.empty()) Inner(0, leaves);
  }
  const std::vector<uint8_t>& bytes() const { return bytes_; }
  int64_t count() const { return count_; }

 private:
  struct Node {
    float value = 0;
    Rgb8 color = kNoColor;
    bool is_leaf = true;
    friend bool operator==(const Node&, const Node&) = default;
  };

  /// The next inner node of the stream, at this depth.
  Node Inner(int depth, Leaves leaves) {
    const uint32_t code = nodes_[at_] | static_cast<uint32_t>(nodes_[at_ + 1]) << 8;
    at_ += 2;
    return WithChildren(depth, leaves, [&](int child, Leaves part) {
      const uint32_t state = (code >> (2 * child)) & 3;
      if (state == 0) return std::optional<Node>();
      if (state == 1) return std::optional(Leaf({kFree, kNoColor}));
      return std::optional(state == 3 ? Inner(depth + 1, part) : Occupied(depth + 1, part));
    });
  }

  /// An occupied cube, in leaves of one colour each.
  Node Occupied(int depth, Leaves leaves) {
    if (leaves.empty()) return Leaf({kOccupied, kUnsegmentedColor});
    if (depth == kDepth) return Leaf({kOccupied, leaves.front().color});
    return WithChildren(depth, leaves,
                        [&](int, Leaves part) { return std::optional(Occupied(depth + 1, part)); });
  }

  Node Leaf(const Node& node) {
    Put(Reserve(), node, 0);
    return node;
  }

  /// Writes a node and its children. When these are eight equal leaves, it becomes such a leaf.
  template <typename Child>
  Node WithChildren(int depth, Leaves leaves, const Child& write_child) {
    const size_t start = Reserve();
    const int64_t count = count_;
    std::array<std::optional<Node>, 8> children;
    uint32_t mask = 0;
    for (int child = 0; child < 8; ++child) {
      const Leaves part = TakeChild(depth, child, &leaves);
      children[static_cast<size_t>(child)] = write_child(child, part);
      mask |= static_cast<uint32_t>(children[static_cast<size_t>(child)].has_value()) << child;
    }
    const bool same = mask == 0xff && children[0]->is_leaf &&
                      std::all_of(children.begin(), children.end(),
                                  [&](const auto& child) { return child == children[0]; });
    if (same) {
      bytes_.resize(start + kNodeBytes);
      count_ = count;
      Put(start, *children[0], 0);
      return *children[0];
    }
    const Node node = Summary(children);
    Put(start, node, mask);
    return node;
  }

  /// The leaves of a child, which come first in `leaves`.
  static Leaves TakeChild(int depth, int child, Leaves* leaves) {
    const int shift = 3 * (kDepth - 1 - depth);
    size_t count = 0;
    while (count < leaves->size() &&
           (((*leaves)[count].order >> shift) & 7) == static_cast<uint64_t>(child))
      ++count;
    const Leaves part = leaves->first(count);
    *leaves = leaves->subspan(count);
    return part;
  }

  /// An inner node is as occupied as its most occupied child, and has the mean of their colours.
  static Node Summary(const std::array<std::optional<Node>, 8>& children) {
    Node node{kFree, kNoColor, false};
    int red = 0, green = 0, blue = 0;
    int colored = 0;
    for (const std::optional<Node>& child : children) {
      if (!child) continue;
      node.value = std::max(node.value, child->value);
      if (child->color == kNoColor) continue;
      ++colored;
      red += child->color.r;
      green += child->color.g;
      blue += child->color.b;
    }
    if (colored > 0) {
      node.color = {static_cast<uint8_t>(red / colored), static_cast<uint8_t>(green / colored),
                    static_cast<uint8_t>(blue / colored)};
    }
    return node;
  }

  size_t Reserve() {
    ++count_;
    bytes_.resize(bytes_.size() + kNodeBytes);
    return bytes_.size() - kNodeBytes;
  }

  void Put(size_t at, const Node& node, uint32_t mask) {
    static_assert(std::endian::native == std::endian::little);
    std::memcpy(&bytes_[at], &node.value, 4);
    bytes_[at + 4] = node.color.r;
    bytes_[at + 5] = node.color.g;
    bytes_[at + 6] = node.color.b;
    bytes_[at + 7] = static_cast<uint8_t>(mask);
  }

  static constexpr size_t kNodeBytes = 8;  // log odds, colour, which children there are
  std::span<const uint8_t> nodes_;
  size_t at_ = 0;
  std::vector<uint8_t> bytes_;
  int64_t count_ = 0;
};

}  // namespace

Result<std::vector<uint8_t>> ColorOctree(std::span<const uint8_t> octree, const SemanticMap& map) {
  const Result<OctreeStreamInfo> info = CheckOctree(octree, "octree to be coloured");
  if (!info) return tl::unexpected(info.error());
  const Result<OctreeGrid> grid = ChooseOctreeGrid(map.voxels.voxel_size(), info->resolution);
  if (!grid) return tl::unexpected(grid.error());
  constexpr std::string_view kHeaderEnd = "\ndata\n";
  const auto found =
      std::search(octree.begin(), octree.end(), kHeaderEnd.begin(), kHeaderEnd.end());
  ColorWriter writer(
      octree.subspan(static_cast<size_t>(found - octree.begin()) + kHeaderEnd.size()));
  writer.Write(ElectColors(VoteCollector(map, grid->factor).Collect()));
  const std::string header =
      "# Octomap OcTree file\n"
      "# (feel free to add / change comments, but leave the first line as it is!)\n"
      "#\nid ColorOcTree\nsize " +
      std::to_string(writer.count()) + "\nres " + ShortestText(info->resolution) + "\ndata\n";
  std::vector<uint8_t> bytes(header.begin(), header.end());
  bytes.insert(bytes.end(), writer.bytes().begin(), writer.bytes().end());
  return bytes;
}

}  // namespace vismap
