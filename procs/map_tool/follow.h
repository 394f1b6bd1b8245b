#pragma once

#include "map_tool/commands.h"

namespace vismap {

/// What a viewer does: keeps a copy of a running server's surface and object list by MESH_DELTA and
/// OBJECTS until it is stopped, or has `arguments.frames` frames; prints a line when they change,
/// in the end the surface's digest; writes the surface to `arguments.out` (PLY) when given.
Outcome RunFollow(const MapToolArguments& arguments, ProcessContext& context);

}  // namespace vismap
