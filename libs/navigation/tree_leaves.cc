#include "navigation/tree_leaves.h"

#include <string_view>

#include "freespace/octree.h"
#include "freespace/octree_cube.h"

namespace vismap {
namespace {

/// Reads nodes that CheckOctree has checked.
class TreeLeafReader {
 public:
  TreeLeafReader(std::span<const uint8_t> nodes, OccupancyMap* leaves)
      : nodes_(nodes), leaves_(leaves) {}

  /// False when there are too many blocks.
  bool Visit(const OctreeCube& cube) {
    const uint32_t code = nodes_[at_] | static_cast<uint32_t>(nodes_[at_ + 1]) << 8;
    at_ += 2;
    if (cube.size == kBlockSide) planes_ = {};
    for (int child = 0; child < 8; ++child) {
      const uint32_t kind = (code >> (2 * child)) & 3;
      if (kind != 0 && !(kind == 3 ? Visit(cube.Child(child)) : Fill(cube.Child(child), kind == 2)))
        return false;
    }
    return cube.size != kBlockSide || Set(BlockOf(cube.min), BlockOccupancy(planes_));
  }

 private:
  bool Fill(const OctreeCube& cube, bool occupied) {
    if (cube.size >= kBlockSide) return FillBlocks(cube, occupied);
    auto& bits = occupied ? planes_.occupied : planes_.free;
    ForEachOffset(cube, [&](size_t offset) { bits[offset / 64] |= uint64_t{1} << (offset % 64); });
    return true;
  }

  bool FillBlocks(const OctreeCube& cube, bool occupied) {
    const BlockOccupancy block(occupied ? CellState::kOccupied : CellState::kFree);
    return ForEachBlock(cube, [&](BlockIndex index) { return Set(index, block); });
  }

  bool Set(BlockIndex index, const BlockOccupancy& block) {
    if (++blocks_ > kMostTreeBlocks) return false;
    leaves_->Set(index, block);
    return true;
  }

  std::span<const uint8_t> nodes_;
  OccupancyMap* leaves_;
  size_t at_ = 0;
  int64_t blocks_ = 0;
  OccupancyPlanes planes_;  // of the block that is being read
};

}  // namespace

Result<OccupancyMap> ReadTreeLeaves(std::span<const uint8_t> bytes, const std::string& name) {
  const Result<OctreeStreamInfo> info = CheckOctree(bytes, name);
  if (!info) return tl::unexpected(info.error());
  OccupancyMap leaves(info->resolution);
  if (info->nodes == 0) return leaves;
  constexpr std::string_view kHeaderEnd = "\ndata\n";
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  TreeLeafReader reader(bytes.subspan(text.find(kHeaderEnd) + kHeaderEnd.size()), &leaves);
  if (!reader.Visit(OctreeCube::Everything())) {
    return Fail(name + ": the tree covers more than " + std::to_string(kMostTreeBlocks) +
                " blocks of 8x8x8 leaves");
  }
  return leaves;
}

}  // namespace vismap
