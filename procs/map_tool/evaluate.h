#pragma once

#include "map_tool/commands.h"

namespace vismap {

/// Scores `arguments.map`, a saved map or a mesh with ids, against `arguments.ground_truth`: a
/// folder that ReadGroundTruth takes, or synthetic:room, whose truth is computed. Prints a table,
/// or JSON; writes the JSON to `arguments.out`, too, when given.
Outcome RunEvaluate(const MapToolArguments& arguments, ProcessContext& context);

}  // namespace vismap
