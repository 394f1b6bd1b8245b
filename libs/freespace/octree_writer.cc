#include <algorithm>
#include <cmath>
#include <system_error>

#include "base/file.h"
#include "freespace/block_region.h"
#include "freespace/octree_builder.h"
#include "freespace/shortest_text.h"

namespace vismap {

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
              ShortestText(voxel_size) + " m, found " + ShortestText(resolution) +
              " m; the nearest is " + ShortestText(nearest) + " m");
}

Result<OctreeBytes> BuildOctree(const OccupancyMap& map, const OctreeOptions& options) {
  Result<OctreeBuilder> builder = OctreeBuilder::Make(map.cell_size(), options);
  if (!builder) return tl::unexpected(builder.error());
  if (!options.bounds_W) {
    builder->Update(map, map.SortedIndices());
    return builder->Build(options.unknown);
  }
  if (const Result<void> checked = CheckOctreeBounds(*options.bounds_W); !checked)
    return tl::unexpected(checked.error());
  const BlockRegion region =
      RegionAround(*options.bounds_W, builder->resolution(), map.cell_size() * kBlockSide);
  builder->Update(map, BlocksIn(map.blocks(), region));
  return builder->Build(options.unknown);
}

Result<void> WriteOctree(const std::filesystem::path& path, const OctreeBytes& octree) {
  if (octree.nodes > 0) return WriteFileAtomically(path, octree.bytes);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
  return Fail("there is no octree of the map in " + path.parent_path().string() +
              ": nothing in it is known to be free or occupied, and collision checkers take an "
              "empty tree for free space");
}

Result<void> SetOctreeAside(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  const std::filesystem::path aside = path.string() + ".previous";
  std::filesystem::rename(path, aside, error);
  if (!error) return {};
  return Fail("the octree of an earlier run, " + path.string() + ", cannot be renamed to " +
              aside.string() + ": " + error.message());
}

}  // namespace vismap
