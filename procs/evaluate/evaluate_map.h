#pragma once

#include <string>

#include "runtime/main.h"
#include "settings/settings.h"

namespace vismap {

/// The command line of vismap-evaluate.
struct EvaluateArguments {
  std::string ground_truth;  ///< folder for ReadGroundTruth, or synthetic:room
  std::string map;           ///< saved map (.vismap), or mesh with ids (.ply)
  std::string objects;       ///< objects.json with the scores of a mesh; "" = the one beside it
  std::string classes;       ///< see ParseClassList
  std::string out;           ///< file for the JSON; "" = none
  bool json = false;         ///< print JSON in place of the table
  bool why = false;          ///< print FindingsTable after the table
  VismapConfig config;
};

/// Evaluates `arguments.map` against `arguments.ground_truth`. Prints a table or JSON, and writes
/// the JSON to `arguments.out` if given.
Outcome RunEvaluate(const EvaluateArguments& arguments);

}  // namespace vismap
