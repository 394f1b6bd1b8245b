#pragma once

#include <tsl/robin_map.h>

#include <cstdint>
#include <span>
#include <vector>

#include "map/label_table.h"
#include "map/surface_reader.h"
#include "map/voxel_map.h"

namespace vismap {

/// In which blocks voxels vote for a label, so that what is read otherwise can be shown otherwise
/// without a look at the whole map.
class LabelPlaces {
 public:
  void Clear();
  /// These blocks changed: takes note of labels that are new there.
  void Note(const VoxelMap& voxels, std::span<const BlockIndex> changed);
  /// `dead` has been merged into `survivor`, which now is where both are.
  void Merge(SegmentLabel dead, SegmentLabel survivor);
  /// The same for all labels that a table knows as merged.
  void MergeAll(const LabelTable& labels);
  /// Blocks where the label, or one merged into it, has votes, or had once; some of them twice.
  std::span<const BlockIndex> Of(SegmentLabel label) const;

 private:
  void NoteBlock(BlockIndex index, const std::vector<SegmentLabel>& palette);

  tsl::robin_map<BlockIndex, uint8_t, BlockIndexHash>
      noted_;                                    // labels of a palette, from its start
  std::vector<std::vector<BlockIndex>> places_;  // by label
};

}  // namespace vismap
