#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "map/label_table.h"
#include "map/voxel_map.h"

namespace vismap {

/// The map: surface, free space and label votes (voxels), and what is known of each label (labels).
/// Only IntegrateFrame (mapping/integrate.h) changes it.
struct SemanticMap {
  explicit SemanticMap(const VoxelGridOptions& grid) : voxels(grid) {}

  VoxelMap voxels;
  LabelTable labels;
  int64_t revision = 0;    ///< +1 per integrated frame
  int64_t last_utime = 0;  ///< latest time of an integrated frame [us]
  /// Position of the camera of the frame that was integrated last [m].
  Eigen::Vector3d last_camera_W = Eigen::Vector3d::Zero();
};

/// Memory of a map with its trajectory [bytes], about; takes constant time.
size_t BytesOf(const SemanticMap& map);

/// The label with most votes, ties to the lower label; kNone without votes. Labels must be alive
/// and may repeat: their votes are summed.
SegmentLabel StrongestLabel(const std::array<LabelVote, kVoteSlots>& votes);

/// Hash of the whole content of a map: grid, voxels, votes, labels, revision; not of the hits of
/// thin things (ThinVoxels), which only tell which voxels are not free. It does not depend on
/// the layout in memory or the number of threads: equal maps have equal hashes.
std::string HashMap(const SemanticMap& map);

}  // namespace vismap
