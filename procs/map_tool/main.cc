#include <functional>

#include "map_tool/commands.h"
#include "map_tool/evaluate_program.h"
#include "map_tool/follow.h"

namespace {

using namespace vismap;

struct Command {
  MapToolArguments arguments;
  std::function<Outcome(const MapToolArguments&, ProcessContext&)> run;
};

constexpr const char* kFile = "Saved map (.vismap)";
constexpr const char* kFileOrLive =
    "Saved map (.vismap), or 'live' for the map of the running server";

CommandLine Add(CommandLine& line, Command* command, const char* name, const char* help,
                Outcome (*run)(const MapToolArguments&, ProcessContext&)) {
  return line.Command(name, help, [command, run] { command->run = run; });
}

/// The same with a map as its first argument.
CommandLine AddWithMap(CommandLine& line, Command* command, const char* name, const char* help,
                       Outcome (*run)(const MapToolArguments&, ProcessContext&),
                       const char* map_help) {
  CommandLine sub = Add(line, command, name, help, run);
  sub.Option("MAP", &command->arguments.map, map_help).Required();
  return sub;
}

/// Options that choose objects; `id_name` = the option for one of them.
void AddChoiceOfObjects(CommandLine& sub, const char* id_name, MapToolArguments* arguments) {
  sub.Option(id_name, &arguments->id, "Only this object: an instance (7) or a segment (s12)");
  sub.Option("--class", &arguments->class_name, "Only objects of this class: COCO name or id");
  sub.Option("--region", &arguments->region,
             "Only objects that overlap the box x0,y0,z0,x1,y1,z1 [m]");
}

void AddWithout(CommandLine& sub, MapToolArguments* arguments) {
  sub.Option("--without", &arguments->without,
             "Objects that are left out, such as 'id=7;class=cup'; with ':unknown' behind one, its "
             "place is unknown, with ':inflate=0.1' it is larger by this [m]");
}

void AddOctree(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  CommandLine octree = AddWithMap(line, command, "octree",
                                  "Write free and occupied space of a map as an OctoMap file",
                                  RunOctree, kFileOrLive);
  octree.Option("--out", &arguments.out, "File for the octree").Required();
  octree
      .Option("--res", &arguments.resolution_m,
              "Edge of a leaf [m], 2 to 64 times the voxel size; 0 = as in the config")
      .Range(0, 64);
  octree.Option("--region", &arguments.region, "Only the box x0,y0,z0,x1,y1,z1 [m]");
  octree
      .Option("--unknown", &arguments.unknown,
              "What unknown space becomes: occupied, as planners need it, or absent; if not given, "
              "occupied, but absent with --color")
      .OneOf({"occupied", "absent"});
  octree
      .Option("--inflate", &arguments.inflate_m,
              "Radius of the robot, by which obstacles and unknown space grow [m]")
      .Range(0, 5);
  AddWithout(octree, &arguments);
  octree.Flag("--color", &arguments.color,
              "Occupied leaves have the colour of their class; for looking, not for planning");
  octree.Flag("--from-exporter", &arguments.from_exporter,
              "Ask the octomap exporter instead of the map server");
}

void AddRender(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  CommandLine render =
      AddWithMap(line, command, "render", "Draw a picture of a map, or of an octree", RunRender,
                 "Saved map (.vismap), 'live', or an octree (.bt, .ot) for --view octree");
  render
      .Option("--out", &arguments.out,
              "PNG file; with --turntable also a folder, or a file that ends in .webp")
      .Required();
  render
      .Option("--view", &arguments.view,
              "overview (from the side and from above), perspective, top, slice through free and "
              "occupied space, or octree")
      .OneOf({"overview", "perspective", "top", "slice", "octree"});
  render
      .Option(
          "--color", &arguments.coloring,
          "Meaning of the colours of a surface: instance (if not given), class, segment, rgb (as "
          "the camera saw it), height, or seen (by how many frames); of an octree: height (if "
          "not given), class, or rgb (those of an .ot file)")
      .OneOf({"instance", "class", "segment", "rgb", "height", "seen"});
  render.Option("--axis", &arguments.axis, "Axis of the map across the slice (default z)")
      .OneOf({"x", "y", "z"});
  render.Option("--at", &arguments.at,
                "Where the slice is on this axis [m]; if not given, in the middle of the map");
  render.Option("--below", &arguments.below,
                "Leave out what is above this height along the upward direction [m]");
  render
      .Option("--turntable", &arguments.turntable,
              "Draw this number of views from all around, of the surface or of the octree")
      .Range(2, 720);
  render
      .Option(
          "--res", &arguments.resolution_m,
          "Edge of a leaf of the octree [m], 2 to 64 times the voxel size; 0 = as in the config")
      .Range(0, 64);
  render.Option("--width", &arguments.width, "Of the picture [px]").Range(320, 8192);
  render.Option("--height", &arguments.height, "Of the picture [px]").Range(240, 8192);
}

void AddReport(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  CommandLine report = AddWithMap(
      line, command, "report",
      "Write one HTML page of a run: map to turn, objects, trajectory, stage times, free space",
      RunReport,
      "Saved map (.vismap), folder of vismap-offline-mapper, 'live', or what is mapped first: a "
      "log or a sequence");
  report.Option("--out", &arguments.out, "HTML file").Required();
  report.Option("--page", &arguments.config.viewer.page_folder,
                "Folder of the viewer's page, with report.js; if not given, beside the program");
  report.Option("--truth", &arguments.truth, "Ground truth for scores, see vismap-evaluate --gt");
}

/// Commands for maps in files.
void AddFileCommands(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  CommandLine files = AddWithMap(
      line, command, "export",
      "Write mesh, objects, octrees and picture of a map to a folder; with --object, --class "
      "or --region, write only mesh (.ply) and points (.xyz) of these objects; with --grid, write "
      "a 2-D grid for wheels",
      RunExport, kFileOrLive);
  files.Option("--out", &arguments.out, "Folder for the results");
  files.Option("--only", &arguments.only, "Write only this into the folder")
      .OneOf({"mesh", "objects", "octree", "octree-closed"});
  files.Option("--grid", &arguments.grid,
               "Write the grid as PGM and YAML, as map_server and nav2 read them: to map.pgm and "
               "map.yaml in this folder, or to WHERE.pgm and WHERE.yaml; the section ground_grid "
               "of the config says how it is made");
  AddChoiceOfObjects(files, "--object", &arguments);
  AddWithout(files, &arguments);

  AddWithMap(line, command, "diff", "Compare two saved maps; exit code 1 if they differ", RunDiff,
             kFile)
      .Option("OTHER", &arguments.other_map, "Saved map to compare with")
      .Required();
  Add(line, command, "evaluate",
      "Evaluate a map against a ground truth; runs vismap-evaluate, whose --help has the options",
      [](const MapToolArguments&, ProcessContext&) -> Outcome {
        return ExitWith(ExitCode::kUsage,
                        "give the options of evaluate behind the word 'evaluate'");
      });

  CommandLine runs =
      Add(line, command, "compare-runs",
          "Find the first frame at which two recorded runs differ; exit code 1 if they differ",
          RunCompareRuns);
  runs.Option("LOG", &arguments.map, "Log of a run with MAP_COMMITs").Required();
  runs.Option("OTHER", &arguments.other_map, "Log to compare with").Required();
}

/// Commands for a running server.
void AddServerCommands(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  line.Option("--timeout", &arguments.timeout, "Seconds to wait for the answer of a server")
      .Positive();

  CommandLine follow =
      Add(line, command, "follow",
          "Keep a copy of the surface of the running server, as a viewer does, until Ctrl-C",
          RunFollow);
  follow.Option("--out", &arguments.out, "Write the surface to this PLY file at the end");
  follow
      .Option("--frames", &arguments.frames,
              "Stop when the map has this number of frames; 0 = never")
      .AtLeast(0);

  Add(line, command, "digests",
      "Print digests of free space and surface of the running server, and of the copy of the "
      "exporter",
      RunDigests)
      .Flag("--json", &arguments.json, "Print JSON");
  Add(line, command, "save",
      "Save the map of the running server: NAME in its folder for maps (map_server.map_folder), or "
      "PATH on this computer",
      RunSave)
      .Option(
          "NAME", &arguments.map,
          "Name of the map: letters, digits, '-', '_' and '.'; with a '/' it is a path on this "
          "computer, to which the map is fetched; if not given, the server saves to its own file "
          "(map_server.save_on_exit)");
  Add(line, command, "load",
      "Make the running server continue a map that is in its folder for maps", RunLoad)
      .Option("NAME", &arguments.map, "Name that the map was saved under")
      .Required();
  CommandLine correct = AddWithMap(
      line, command, "correct",
      "Send new poses of frames that the map has, and wait until the server has made the map again",
      RunCorrect, "'live', the map of the running server");
  correct
      .Option("--poses", &arguments.poses,
              "Trajectory in the format of TUM: TIME tx ty tz qx qy qz qw, time in seconds")
      .Required();
  correct.Option("--camera", &arguments.camera_id, "Camera of the frames").AtLeast(0);
  correct.Flag("--interpolate", &arguments.interpolate,
               "The file has key frames; the frames between them are moved with them");
  Add(line, command, "reset", "Make the running server start an empty map", RunReset);
}

/// Questions of planners, which the octomap exporter answers, or this program for a saved map.
void AddNavigationCommands(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  const auto add_common = [&](CommandLine& sub) {
    sub.Option("--res", &arguments.resolution_m,
               "Edge of a leaf [m], 2 to 64 times the voxel size; 0 = as in the config")
        .Range(0, 64);
    AddWithout(sub, &arguments);
    sub.Flag("--json", &arguments.json, "Print JSON");
  };
  CommandLine clearance = AddWithMap(
      line, command, "clearance", "Print how far points are from obstacles and from unknown space",
      RunClearance, kFileOrLive);
  clearance.Option("--at", &arguments.points, "Points x,y,z;x,y,z [m]").Required();
  add_common(clearance);
  CommandLine cell = AddWithMap(
      line, command, "cell",
      "Say why the map shows what it shows at a point: state, distance, weight, votes of labels",
      RunCell, kFileOrLive);
  cell.Option("--at", &arguments.points, "Point x,y,z [m]").Required();
  cell.Flag("--json", &arguments.json, "Print JSON");
  CommandLine frontiers =
      AddWithMap(line, command, "frontiers",
                 "List where the map can grow, and from where that is seen, the largest first",
                 RunFrontiers, kFileOrLive);
  frontiers.Option("--region", &arguments.region, "Only in the box x0,y0,z0,x1,y1,z1 [m]");
  frontiers
      .Option("--radius", &arguments.inflate_m,
              "Radius of the robot [m]; 0 = octomap_exporter.robot_radius_m")
      .Range(0, 5);
  add_common(frontiers);
}

void AddCommands(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  AddWithMap(line, command, "info", "Print statistics of a map", RunInfo, kFileOrLive)
      .Flag("--json", &arguments.json, "Print JSON");
  AddWithMap(line, command, "hash", "Print the hash of a map; equal maps have equal hashes",
             RunHash, kFileOrLive);
  CommandLine objects =
      AddWithMap(line, command, "objects", "List the objects of a map", RunObjects, kFileOrLive);
  objects.Flag("--json", &arguments.json, "Print JSON, including discovered segments");
  AddChoiceOfObjects(objects, "--id", &arguments);
  AddOctree(line, command);
  AddRender(line, command);
  AddReport(line, command);
  AddFileCommands(line, command);
  AddNavigationCommands(line, command);
  AddServerCommands(line, command);
}

}  // namespace

int main(int argc, char** argv) {
  if (ChoosesEvaluate(argc, argv)) return RunEvaluateProgram(argc, argv);
  Command command;
  ProcessSpec spec;
  spec.name = "map";
  spec.summary = "Inspects saved maps and controls a running map server.";
  spec.joins_bus = false;
  spec.add_options = [&](CommandLine& line) { AddCommands(line, &command); };
  UseConfig(&command.arguments.config, &spec);
  spec.run = [&](ProcessContext& context) { return command.run(command.arguments, context); };
  return RunProcess(argc, argv, spec);
}
