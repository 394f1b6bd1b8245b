#pragma once

#include <octomap/octomap.h>

#include <memory>
#include <optional>
#include <sstream>
#include <string>

#include "freespace/octree.h"
#include "freespace/octree_cache.h"

namespace vismap::testing_support {

/// The octree of a map whose cells are the leaves.
inline Result<OctreeBytes> EncodeOctree(const OccupancyMap& leaves, double resolution,
                                        UnknownPolicy unknown,
                                        const std::optional<Eigen::AlignedBox3d>& bounds_W,
                                        double shell_m = 0) {
  OctreeCache cache;
  cache.Update(leaves, leaves.SortedIndices());
  return cache.Encode(
      leaves,
      {.resolution_m = resolution, .unknown = unknown, .bounds_W = bounds_W, .shell_m = shell_m});
}

/// The tree that OctoMap reads from a `.bt` stream. Fails when CheckOctree fails.
inline Result<std::unique_ptr<octomap::OcTree>> ReadOctree(std::span<const uint8_t> bytes,
                                                           const std::string& name) {
  const Result<OctreeStreamInfo> info = CheckOctree(bytes, name);
  if (!info) return tl::unexpected(info.error());
  std::istringstream stream(std::string(bytes.begin(), bytes.end()));
  auto tree = std::make_unique<octomap::OcTree>(info->resolution);
  if (!tree->readBinary(stream)) return Fail(name + ": OctoMap cannot read it");
  if (static_cast<int64_t>(tree->size()) != info->nodes)
    return Fail(name + ": OctoMap reads " + std::to_string(tree->size()) + " nodes");
  return tree;
}

inline CellState CellAt(const octomap::OcTree& tree, const Eigen::Vector3d& p_W) {
  const octomap::OcTreeNode* node = tree.search(p_W.x(), p_W.y(), p_W.z());
  if (node == nullptr) return CellState::kUnknown;
  return tree.isNodeOccupied(node) ? CellState::kOccupied : CellState::kFree;
}

}  // namespace vismap::testing_support
