#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <vismap/map_delta_t.hpp>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// Largest number of blocks in one message. Decode rejects more, because 25 kB of zstd can
/// decompress to a gigabyte of blocks.
inline constexpr int32_t kMaxBlocksPerUpdate = 65536;

/// The content of one MAP_DELTA: the occupancy that changed between two revisions of a map, or a
/// snapshot of all of it.
struct MapUpdate {
  int64_t utime = 0;           ///< of the newest frame contained [us]
  std::string map_id;          ///< a reset and a load change it
  int64_t revision = 0;        ///< of the map after this update
  int64_t base_revision = -1;  ///< revision that the receiver must have; -1 = snapshot
  int32_t part = 0;            ///< index of this part, 0 to parts - 1
  int32_t parts = 1;
  OccupancyDelta delta;  ///< if `complete`: part of a snapshot, which replaces the whole copy when
                         ///< all parts have arrived
};

map_delta_t Encode(const MapUpdate& update);

/// Fails, naming the field, on every value that Encode does not produce.
Result<MapUpdate> Decode(const map_delta_t& message);

/// Splits an update into parts of at most `max_blocks` blocks, to bound the size of a message. An
/// empty update gives one part.
std::vector<MapUpdate> SplitUpdate(MapUpdate update, size_t max_blocks);

}  // namespace vismap
