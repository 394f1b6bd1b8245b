#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// How unknown space is written. Collision checkers like FCL treat space without a node as free.
enum class UnknownPolicy : uint8_t {
  kAbsent = 0,    ///< without nodes, as OctoMap defines it
  kOccupied = 1,  ///< as occupied within the bounds and in a shell around them: a closed tree
};

inline constexpr auto NamesOf(UnknownPolicy) {
  return std::to_array<EnumName<UnknownPolicy>>(
      {{"ABSENT", UnknownPolicy::kAbsent}, {"OCCUPIED", UnknownPolicy::kOccupied}});
}

struct OctreeOptions {
  /// Edge of a leaf [m]: a whole multiple, 2 to 64, of the voxel size. 0 = the smallest such
  /// multiple of at least 5 cm.
  double resolution_m = 0;
  UnknownPolicy unknown = UnknownPolicy::kAbsent;
  double free_fraction = 1.0;  ///< share of a leaf's voxels that must be free, (0, 1]
  /// Bounds of the tree [m]; nullopt = the box around all known cells.
  std::optional<Eigen::AlignedBox3d> bounds_W{};
  /// A closed tree is occupied everywhere up to this far outside of its bounds, and in places up to
  /// 32 leaves farther, where nodes are then larger [m]. 0 = it ends at its bounds, and collision
  /// checkers take all beyond for free.
  double shell_m = 1;
};

/// A whole OctoMap file with its text header, and its properties.
struct OctreeBytes {
  std::vector<uint8_t> bytes;
  double resolution = 0;  ///< edge of a leaf [m]
  int64_t nodes = 0;      ///< inner nodes and leaves; 0 = empty tree
  UnknownPolicy unknown = UnknownPolicy::kAbsent;
  /// Bounds of the tree [m], without its shell; empty for an empty tree.
  Eigen::AlignedBox3d bounds_W;
  double shell_m = 0;      ///< see OctreeOptions; 0 unless the tree is closed
  std::string left_out{};  ///< one sentence when parts of the map are not in the tree; "" = all are
};

/// The size of leaves.
struct OctreeGrid {
  int factor = 0;         ///< voxels along the edge of a leaf
  double resolution = 0;  ///< edge of a leaf [m]
};

/// The grid for a voxel size [m] and OctreeOptions::resolution_m [m]. Fails when the resolution is
/// not a whole multiple of the voxel size; the Error names the nearest possible one.
Result<OctreeGrid> ChooseOctreeGrid(double voxel_size, double resolution);

/// Fails unless the corners of a box are finite and each minimum is below its maximum.
Result<void> CheckOctreeBounds(const Eigen::AlignedBox3d& bounds_W);

/// The map as an OctoMap `.bt` stream. A leaf is occupied when any of its voxels is occupied, free
/// when none is occupied and enough voxels are free, else unknown. OctoMap has 32768 leaves from
/// the origin along each axis; what lies beyond is left out. With bounds, only the blocks that they
/// touch are read. Fails on a resolution that is no multiple of the voxel size, on bounds that are
/// not finite, inverted or without the centre of a leaf, when all of the map lies beyond, and when
/// unknown space shall be occupied in a box whose sides have more than 2^26 leaves.
Result<OctreeBytes> BuildOctree(const OccupancyMap& map, const OctreeOptions& options);

/// Writes the stream to a file, see WriteFileAtomically; the folder must exist. Collision checkers
/// take a tree without nodes, in which nothing is known, for free space everywhere. So it is not
/// written: the Error says why there is no octree, and an older file at `path` is removed.
Result<void> WriteOctree(const std::filesystem::path& path, const OctreeBytes& octree);

/// Renames an octree of an earlier run to PATH.previous, so that readers do not take it for one of
/// the present map. Does nothing when there is none.
Result<void> SetOctreeAside(const std::filesystem::path& path);

/// Properties of a `.bt` stream.
struct OctreeStreamInfo {
  double resolution = 0;  ///< edge of a leaf [m]
  int64_t nodes = 0;      ///< inner nodes and leaves
};

/// Checks a whole `.bt` stream without building the tree: header, depth, number of nodes, no bytes
/// missing or left over. `name` begins the message of an error.
Result<OctreeStreamInfo> CheckOctree(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace vismap
