#pragma once

#include "map_tool/commands.h"

namespace vismap {

/// Evaluates `arguments.map`, a saved map or a mesh with ids, against `arguments.ground_truth`, a
/// folder for ReadGroundTruth or synthetic:room, whose ground truth is computed. Prints a table or
/// JSON, and writes the JSON to `arguments.out` if given.
Outcome RunEvaluate(const MapToolArguments& arguments, ProcessContext& context);

}  // namespace vismap
