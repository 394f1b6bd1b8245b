#pragma once

#include "map/map_metadata.h"
#include "map/semantic_map.h"
#include "map_server/shared_trajectory.h"
#include "wire/update_sequence.h"

namespace vismap {

/// The map of a server as it was at one moment, for work that takes longer than the mapping may
/// wait. It shares with the map what has not changed since, see Shared.
struct MapSnapshot {
  SemanticMap map;
  MapMetadata metadata;  ///< without its trajectory until Complete
  SharedTrajectory trajectory{};

  /// Fills in the trajectory, which takes time in proportion to the frames.
  void Complete() { metadata.trajectory = trajectory.Collect(); }
  FollowerPosition position() const { return {metadata.map_id, map.revision}; }
};

}  // namespace vismap
