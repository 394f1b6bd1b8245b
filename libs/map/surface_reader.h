#pragma once

#include <cstddef>
#include <deque>
#include <memory>

#include "map/block.h"

namespace vismap {

/// Reads the voxels of blocks, packed or not, without changing the map, and keeps copies of packed
/// ones. One per thread; the map must not change while it is in use.
class SurfaceReader {
 public:
  /// The voxels of a block near a surface; nullptr for other blocks. Valid until Trim.
  const SurfaceVoxels* Read(const Block& block) {
    return block.surface.packed() ? ReadPacked(block) : block.surface.get();
  }

  /// Drops all copies but the `keep` newest.
  void Trim(size_t keep = 0);

 private:
  struct Copy {
    const Block* block = nullptr;
    std::unique_ptr<SurfaceVoxels> voxels;
  };
  const SurfaceVoxels* ReadPacked(const Block& block);

  std::deque<Copy> copies_;  // oldest first
  std::deque<std::unique_ptr<SurfaceVoxels>> spare_;
};

}  // namespace vismap
