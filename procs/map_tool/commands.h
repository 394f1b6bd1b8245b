#pragma once

#include <optional>
#include <string>

#include "runtime/main.h"
#include "settings/settings.h"

namespace vismap {

/// The command line of vismap-map.
struct MapToolArguments {
  std::string map, other_map, out;  ///< files; `map` may be "live", the map of a running server
  std::string coloring;             ///< for render; "" = as is usual for the view
  std::string view = "overview";    ///< for render
  std::optional<std::string> axis;  ///< for render: across the slice; nullopt = z
  std::optional<double> at, below;  ///< for render: place of the slice, height of the cut [m]
  std::optional<int> turntable;     ///< for render: number of views
  int width = 1600, height = 900;   ///< for render [px]
  bool json = false;                ///< print JSON
  std::optional<std::string> id, class_name, region;  ///< for objects and export: the selection
  std::string only;         ///< for export: the one thing that is written; "" = everything
  std::string grid;         ///< for export: where the 2-D grid is written, see WriteGridFiles
  int frames = 0;           ///< for follow: stop when the map has this number of frames; 0 = never
  double timeout = 60;      ///< longest wait for the answer of a server [s]
  double resolution_m = 0;  ///< edge of a leaf; 0 = as in the config
  std::string unknown;      ///< for octree: "occupied", "absent" or, for the usual, ""
  double inflate_m = 0;     ///< for octree and frontiers: radius of the robot
  std::string without;      ///< for questions about free space: objects that are left out
  bool color = false;       ///< for octree: a ColorOcTree
  std::string points;       ///< for clearance: "x,y,z;x,y,z" [m]; for cell: "x,y,z"
  std::string truth;        ///< for report: the ground truth; "" = none
  bool from_exporter = false;  ///< for octree: ask the octomap exporter
  std::string poses;           ///< for correct: file of a trajectory, see ReadTumTrajectory
  int camera_id = 0;           ///< for correct: of the frames
  bool interpolate = false;    ///< for correct: frames between those in the file change, too
  VismapConfig config;
};

/// The subcommands. They print results to stdout and everything else to the log.
Outcome RunInfo(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunHash(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunObjects(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunExport(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunCell(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunClearance(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunFrontiers(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunOctree(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunRender(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunReport(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunDiff(const MapToolArguments& arguments, ProcessContext& context);
/// Here `map` and `other_map` are logs.
Outcome RunCompareRuns(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunSave(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunLoad(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunDigests(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunCorrect(const MapToolArguments& arguments, ProcessContext& context);
Outcome RunReset(const MapToolArguments& arguments, ProcessContext& context);

}  // namespace vismap
