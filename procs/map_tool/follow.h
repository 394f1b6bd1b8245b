#pragma once

#include "map_tool/commands.h"

namespace vismap {

/// Keeps a copy of the surface of a running server, as a viewer does, until it is stopped or the
/// map has `arguments.frames` frames. Prints a line after every update, and the digest of the
/// surface at the end. Writes the surface to `arguments.out` (PLY) if given.
Outcome RunFollow(const MapToolArguments& arguments, ProcessContext& context);

}  // namespace vismap
