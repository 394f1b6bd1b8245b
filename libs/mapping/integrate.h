#pragma once

#include <utility>
#include <vector>

#include "association/associate.h"
#include "mapping/semantic_map.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// What one frame changed.
struct MapDelta {
  int64_t revision = 0;  ///< of the map after the frame
  std::vector<BlockIndex>
      changed_blocks;  ///< ascending; surface, labels or free space differ from before
  std::vector<std::pair<SegmentLabel, SegmentLabel>> merged;  ///< (dead, survivor), in order
  int64_t voxels_updated = 0;
  int64_t votes_evicted = 0;  ///< label votes lost to full slots
};

struct IntegrationOptions {
  double min_range = 0.1;  ///< nearer returns are ignored [m]
  double max_range = 5.0;  ///< farther returns clear free space up to here and leave no surface [m]
  double free_space_range = 5.0;      ///< free space is recorded up to here [m]
  bool free_space = true;             ///< record seen-empty space
  double max_weight = 400.0;          ///< weight cap of a voxel; 1 = one observation at 1 m
  double vote_distance_voxels = 1.0;  ///< labels are voted for within this distance of the surface
};

/// The only function that changes a map: fuses one associated frame (Grinvald 2019, Sec. III-D).
MapDelta IntegrateFrame(const SegmentedFrame& frame, const FrameAssociation& association,
                        const IntegrationOptions& options, SemanticMap* map);

}  // namespace vismap
