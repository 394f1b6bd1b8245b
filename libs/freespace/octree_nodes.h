#pragma once

#include <cstdint>
#include <vector>

#include "freespace/octree.h"
#include "freespace/octree_cube.h"

namespace vismap {

/// What a parent's two bits say of a child in a `.bt` stream.
enum class NodeState : uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2, kInner = 3 };

/// A node and all below it. In a `.bt` stream these bytes stand together, wherever the node is, so
/// that they can be kept and copied.
struct Subtree {
  NodeState state = NodeState::kUnknown;
  int64_t nodes = 0;           ///< nodes below this one
  std::vector<uint8_t> bytes;  ///< empty unless kInner
};

/// Writes the nodes of a tree depth first, as OctoMap does: two bytes per inner node, two bits per
/// child, before the children's own nodes. A node whose children are all free, or all occupied,
/// becomes a leaf on the way back up, which is OctoMap's pruning.
class NodeWriter {
 public:
  /// Begins a node, before its children are written.
  size_t Reserve() {
    bytes_.resize(bytes_.size() + 2);
    return bytes_.size() - 2;
  }

  /// Fills in a node's two bytes, or takes them back when it needs none. `code` = the states of its
  /// children, see Code.
  NodeState Finish(size_t start, uint32_t code);

  /// Writes a node with all below it.
  NodeState Append(const Subtree& subtree) {
    bytes_.insert(bytes_.end(), subtree.bytes.begin(), subtree.bytes.end());
    nodes_ += subtree.nodes;
    return subtree.state;
  }

  static uint32_t Code(NodeState state, int child) {
    return static_cast<uint32_t>(state) << (2 * child);
  }

  void CountRoot() { ++nodes_; }  ///< which no node has as a child
  void ReserveBytes(size_t size) { bytes_.reserve(size); }
  const std::vector<uint8_t>& bytes() const { return bytes_; }
  int64_t nodes() const { return nodes_; }  ///< children of the nodes written so far

 private:
  std::vector<uint8_t> bytes_;
  int64_t nodes_ = 0;
};

/// The node of a block or of a larger cube within `box`. `leaves` = cells of the leaf size; nullptr
/// = nothing is known.
Subtree EncodeSubtree(const OctreeCube& cube, const OccupancyMap* leaves, const OccupancyBox& box,
                      UnknownPolicy unknown);

}  // namespace vismap
