#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// What becomes of space that the map knows nothing of. FCL, and planners on top of it, take an
/// absent node for free.
enum class UnknownPolicy : uint8_t {
  kAbsent = 0,    ///< no node: honest
  kOccupied = 1,  ///< occupied, inside the bounds of the tree: what a collision checker needs
};

struct OctreeOptions {
  /// Edge of a leaf [m]: a whole multiple, 2 to 64, of the voxel size. 0 = the smallest such
  /// multiple of at least 5 cm.
  double resolution = 0;
  UnknownPolicy unknown = UnknownPolicy::kAbsent;
  double free_fraction = 1.0;  ///< part of a leaf's voxels that must be free, (0, 1]
  /// Only leaves within this box [m]; nothing = the box around all that is known.
  std::optional<Eigen::AlignedBox3d> bounds_W;
};

/// A whole OctoMap file, text header included, and what it is.
struct OctreeBytes {
  std::vector<uint8_t> bytes;
  double resolution = 0;  ///< edge of a leaf [m]
  int64_t nodes = 0;      ///< inner nodes and leaves; 0 = empty tree
  UnknownPolicy unknown = UnknownPolicy::kAbsent;
  Eigen::AlignedBox3d bounds_W;  ///< the region that the tree speaks about [m]; empty = none
};

/// Edge of a leaf, and how many voxels that is.
struct OctreeGrid {
  int factor = 0;
  double resolution = 0;  ///< [m]
};

/// Resolves OctreeOptions::resolution. Fails, naming the nearest one possible, when it is not a
/// whole multiple of the voxel size.
Result<OctreeGrid> ChooseOctreeGrid(double voxel_size, double resolution);

/// The map as an OctoMap `.bt` stream. A leaf is occupied when any of its voxels is, free when
/// enough of them are free and none is occupied, and else unknown. Fails on a resolution that does
/// not fit, or a map too large for OctoMap's 65536 leaves along an axis.
Result<OctreeBytes> BuildOctree(const OccupancyMap& map, const OctreeOptions& options);

/// Writes the stream to a file, all or nothing; the directory must exist.
Result<void> WriteOctree(const std::filesystem::path& path, const OctreeBytes& octree);

/// What a `.bt` stream holds.
struct OctreeStreamInfo {
  double resolution = 0;  ///< edge of a leaf [m]
  int64_t nodes = 0;      ///< inner nodes and leaves
};

/// Checks every byte of a stream (header, depth, node count, nothing missing, nothing left over)
/// without building the tree: needs no memory. `name` stands in the error.
Result<OctreeStreamInfo> CheckOctree(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace vismap
