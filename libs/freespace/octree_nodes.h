#pragma once

#include <cstdint>
#include <vector>

#include "freespace/octree.h"
#include "freespace/octree_cube.h"

namespace vismap {

/// The state of a child in a `.bt` stream: two bits in its parent.
enum class NodeState : uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2, kInner = 3 };

/// A node and all nodes below it. In a `.bt` stream their bytes are contiguous and do not depend on
/// the position of the node, so that they can be kept and copied.
struct Subtree {
  NodeState state = NodeState::kUnknown;
  int64_t nodes = 0;           ///< nodes below this one
  std::vector<uint8_t> bytes;  ///< empty unless kInner
};

/// Writes the nodes of a tree depth first, as OctoMap does: two bytes per inner node with two bits
/// per child, then the nodes of the children. A node whose children are all free or all occupied
/// becomes a leaf, which is OctoMap's pruning.
class NodeWriter {
 public:
  /// Reserves the bytes of a node, before its children are written, and returns their position.
  size_t Reserve() {
    bytes_.resize(bytes_.size() + 2);
    return bytes_.size() - 2;
  }

  /// Writes the bytes of a node at `start`, or removes them when the node is a leaf. `code`: the
  /// states of its children, see Code.
  NodeState Finish(size_t start, uint32_t code);

  /// Appends a node with all nodes below it.
  NodeState Append(const Subtree& subtree) {
    bytes_.insert(bytes_.end(), subtree.bytes.begin(), subtree.bytes.end());
    nodes_ += subtree.nodes;
    return subtree.state;
  }

  static uint32_t Code(NodeState state, int child) {
    return static_cast<uint32_t>(state) << (2 * child);
  }

  /// Adds the root to the number of nodes: as no node's child it was not counted.
  void CountRoot() { ++nodes_; }
  void ReserveBytes(size_t size) { bytes_.reserve(size); }
  const std::vector<uint8_t>& bytes() const { return bytes_; }
  int64_t nodes() const { return nodes_; }  ///< children of the nodes written so far

 private:
  std::vector<uint8_t> bytes_;
  int64_t nodes_ = 0;
};

/// The node of a block or of a larger cube, within `extent`. `leaves`: the map in cells of the size
/// of leaves; nullptr = unknown everywhere.
Subtree EncodeSubtree(const OctreeCube& cube, const OccupancyMap* leaves,
                      const OctreeExtent& extent, UnknownPolicy unknown);

}  // namespace vismap
