#pragma once

#include <string>

#include "mapfile/map_file.h"

namespace vismap {

/// Statistics of a map as a JSON object on one line: map_id, hash, revision, voxel_size_m,
/// truncation_m, frames, last_utime, blocks (in total and by kind), bytes (in total and by layer),
/// segments and instances (current, and ever created). The keys have a fixed order.
std::string StatisticsJson(const SemanticMap& map, const MapMetadata& metadata);

}  // namespace vismap
