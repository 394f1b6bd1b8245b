#pragma once

#include <optional>
#include <string>
#include <vismap/map_request_t.hpp>

#include "freespace/occupancy_map.h"
#include "map_tool/commands.h"
#include "mapfile/map_file.h"

namespace vismap {

/// A request about free space, with what the command line states: edge of a leaf, radius, policy,
/// box, and objects that are left out. Fails on a region that is no box.
Result<map_request_t> SpaceRequest(const MapToolArguments& arguments, const std::string& verb);

/// The voxels of a map that differ without the objects of --without; nullopt without that option.
tl::expected<std::optional<OccupancyDelta>, ExitFailure> EditsOf(const MapToolArguments& arguments,
                                                                 const LoadedMap& loaded);
/// The free space of a map, without its FarParts and without these objects.
tl::expected<OccupancyMap, ExitFailure> SpaceOf(const MapToolArguments& arguments,
                                                const LoadedMap& loaded);

}  // namespace vismap
