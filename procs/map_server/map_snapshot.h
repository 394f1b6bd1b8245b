#pragma once

#include "map/map_metadata.h"
#include "map/semantic_map.h"
#include "wire/update_sequence.h"

namespace vismap {

/// The map of a server as it was at one moment, for work that takes longer than the mapping may
/// wait. It shares with the map what has not changed since, see Shared.
struct MapSnapshot {
  SemanticMap map;
  MapMetadata metadata;

  FollowerPosition position() const { return {metadata.map_id, map.revision}; }
};

}  // namespace vismap
