#pragma once

#include "exports/outputs.h"
#include "map_tool/commands.h"
#include "mapfile/map_file.h"
#include "objects/object_query.h"

namespace vismap {

/// The objects that the command line selects.
Result<ObjectQuery> QueryOf(const MapToolArguments& arguments);

/// The mesh of a map, and the selected objects only.
tl::expected<MapProducts, ExitFailure> SelectProducts(const MapToolArguments& arguments,
                                                      const LoadedMap& loaded,
                                                      const ObjectQuery& query);

}  // namespace vismap
