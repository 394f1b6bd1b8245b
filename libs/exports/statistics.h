#pragma once

#include <string>

#include "mapfile/map_file.h"

namespace vismap {

/// Facts of a map as a JSON object: map_id, hash, revision, voxel_size_m, truncation_m, frames,
/// blocks (by kind), bytes (by layer, and in all), segments (alive and ever), instances. Keys in a
/// fixed order.
std::string StatisticsJson(const SemanticMap& map, const MapMetadata& metadata);

}  // namespace vismap
