#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <vismap/map_delta_t.hpp>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// A part of an update with more blocks is refused: 25 kB of zstd could hold a gigabyte of them.
inline constexpr int32_t kMaxBlocksPerUpdate = 65536;

/// Occupancy that changed between two revisions of a map, or all of it, as MAP_DELTA carries it.
struct MapUpdate {
  int64_t utime = 0;           ///< of the newest frame contained [us]
  std::string map_id;          ///< changes on reset and load
  int64_t revision = 0;        ///< of the map after this update
  int64_t base_revision = -1;  ///< what the receiver must have; -1 with a snapshot
  int32_t part = 0;            ///< this is part 0..parts-1 of the update
  int32_t parts = 1;
  OccupancyDelta
      delta;  ///< complete = part of a snapshot: replaces everything once all parts are there
};

map_delta_t Encode(const MapUpdate& update);

/// Fails, naming the field, on anything that Encode would not write.
Result<MapUpdate> Decode(const map_delta_t& message);

/// Cuts an update into parts of at most `max_blocks` blocks, so that no message grows large. An
/// empty update is one part.
std::vector<MapUpdate> SplitUpdate(MapUpdate update, size_t max_blocks);

}  // namespace vismap
