#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "map/label_table.h"
#include "map/voxel_map.h"

namespace vismap {

/// The map: surface, free space and label votes (voxels), and what is known of each label (labels).
/// Changed only by IntegrateFrame (mapping/integrate.h); everything else reads it.
struct SemanticMap {
  explicit SemanticMap(const VoxelGridOptions& grid) : voxels(grid) {}

  VoxelMap voxels;
  LabelTable labels;
  int64_t revision = 0;                                     ///< +1 for every integrated frame
  int64_t last_utime = 0;                                   ///< of the newest integrated frame [us]
  Eigen::Vector3d last_camera_W = Eigen::Vector3d::Zero();  ///< where its camera stood [m]
};

/// The winner among votes for canonical labels, which may repeat.
SegmentLabel StrongestLabel(const std::array<LabelVote, kVoteSlots>& votes);

/// Digest of everything that the map says (grid, voxels, votes, labels, revision), independent of
/// memory layout and of the number of threads: equal maps, equal hashes.
std::string HashMap(const SemanticMap& map);

}  // namespace vismap
