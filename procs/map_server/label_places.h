#pragma once

#include <tsl/robin_map.h>

#include <cstdint>
#include <span>
#include <vector>

#include "volume/surface_reader.h"
#include "volume/voxel_map.h"

namespace vismap {

/// In which blocks voxels vote for a label, so that what is read otherwise can be shown otherwise
/// without a look at the whole map.
class LabelPlaces {
 public:
  void Clear();
  /// These blocks changed: takes note of labels that are new there.
  void Note(const VoxelMap& voxels, std::span<const BlockIndex> changed);
  /// Blocks where the label has votes, or had once.
  std::span<const BlockIndex> Of(SegmentLabel label) const;

 private:
  void NoteBlock(BlockIndex index, const std::vector<SegmentLabel>& palette);

  tsl::robin_map<BlockIndex, uint8_t, BlockIndexHash>
      noted_;                                    // labels of a palette, from its start
  std::vector<std::vector<BlockIndex>> places_;  // by label
};

}  // namespace vismap
