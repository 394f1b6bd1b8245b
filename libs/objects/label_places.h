#pragma once

#include <tsl/robin_map.h>

#include <cstdint>
#include <span>
#include <vector>

#include "map/label_table.h"
#include "map/surface_reader.h"
#include "map/voxel_map.h"

namespace vismap {

/// The blocks in which voxels vote for each label. When the instance or class of a label changes,
/// the blocks that show it are found here without a search through the whole map.
class LabelPlaces {
 public:
  void Clear();
  /// Adds the labels that changed blocks have votes for.
  void AddBlocks(const VoxelMap& voxels, std::span<const BlockIndex> changed);
  /// `dead` was merged into `survivor`, which gets the blocks of both.
  void Merge(SegmentLabel dead, SegmentLabel survivor);
  /// Does the same for all labels that the table has merged.
  void MergeAll(const LabelTable& labels);
  /// Blocks where the label, or one merged into it, has votes or had votes once; some blocks may be
  /// listed twice.
  std::span<const BlockIndex> BlocksOf(SegmentLabel label) const;
  /// Memory [bytes], about.
  size_t bytes() const;

 private:
  void AddBlock(BlockIndex index, const std::vector<SegmentLabel>& palette);

  tsl::robin_map<BlockIndex, uint8_t, BlockIndexHash>
      known_;                                    // how many labels of a block's palette are added
  std::vector<std::vector<BlockIndex>> places_;  // by label
};

}  // namespace vismap
