#pragma once

#include <optional>
#include <string>

#include "runtime/main.h"
#include "settings/settings.h"

namespace vismap {

/// What the user of vismap-map asked for.
struct MapToolArguments {
  std::string map, other_map, out;    ///< files; `map` may be "live": the one of a running server
  std::string coloring = "instance";  ///< of render
  std::string view = "overview";      ///< of render
  bool json = false;                  ///< machine-readable output
  std::string ground_truth, objects, classes;         ///< of evaluate
  std::optional<std::string> id, class_name, region;  ///< of objects and export: which
  int frames = 0;       ///< of follow: enough once the map has so many; 0 = never
  double timeout = 60;  ///< patience with a running server [s]
  VismapConfig config;
};

/// The subcommands. Results go to stdout, everything else to the log.
Outcome RunInfo(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunHash(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunObjects(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunExport(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunRender(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunDiff(const MapToolArguments& arguments, ProcessContext& context);
/// `map` and `other_map` are logs here.
Outcome RunCompareRuns(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunSave(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunLoad(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunDigests(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunReset(const MapToolArguments& arguments, ProcessContext& context);

}  // namespace vismap
