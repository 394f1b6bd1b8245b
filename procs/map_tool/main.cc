#include <functional>

#include "map_tool/commands.h"
#include "map_tool/evaluate.h"
#include "map_tool/follow.h"

namespace {

using namespace vismap;

struct Command {
  MapToolArguments arguments;
  std::function<Outcome(const MapToolArguments&, ProcessContext&)> run;
};

constexpr const char* kFile = "Saved map (.vismap)";
constexpr const char* kFileOrLive = "Saved map (.vismap), or live: the one of the running server";

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
  sub.Option(id_name, &arguments->id, "Only this: an instance (7) or a segment (s12)");
  sub.Option("--class", &arguments->class_name, "Only this class: COCO name or id");
  sub.Option("--region", &arguments->region,
             "Only what reaches into the box x0,y0,z0,x1,y1,z1 [m]");
}

void AddEvaluate(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  CommandLine sub =
      Add(line, command, "evaluate", "How good a map is, against a ground truth", RunEvaluate);
  sub.Option("--gt", &arguments.ground_truth,
             "Folder with the ground truth of a SceneNN or ScanNet sequence, or synthetic:room")
      .Required();
  sub.Option("--map", &arguments.map, "Saved map (.vismap), or mesh with ids (.ply)").Required();
  sub.Option("--objects", &arguments.objects,
             "objects.json of a mesh, for the scores; when not given, the one beside it");
  sub.Option("--classes", &arguments.classes,
             "paper (its nine), scene (all that the ground truth has), or COCO names with commas "
             "between; when not given, paper, for synthetic:room scene");
  sub.Flag("--json", &arguments.json, "Print JSON");
  sub.Option("--out", &arguments.out, "Write the JSON to this file, too");
}

/// Commands for maps in files.
void AddFileCommands(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  CommandLine files = AddWithMap(
      line, command, "export",
      "Mesh, objects, octrees and picture of a saved map, into a folder; with --object, --class "
      "or --region only mesh (.ply) and points (.xyz) of these objects",
      RunExport, kFile);
  files.Option("--out", &arguments.out, "Folder for the results").Required();
  AddChoiceOfObjects(files, "--object", &arguments);

  CommandLine render =
      AddWithMap(line, command, "render", "A picture of a saved map", RunRender, kFile);
  render.Option("--out", &arguments.out, "PNG file").Required();
  render.Option("--color", &arguments.coloring, "What colours show")
      .OneOf({"instance", "class", "segment", "rgb"});
  render.Option("--view", &arguments.view, "overview (with legend), perspective or top")
      .OneOf({"overview", "perspective", "top"});

  AddWithMap(line, command, "diff", "In what two saved maps differ; exit code 1 when they do",
             RunDiff, kFile)
      .Option("OTHER", &arguments.other_map, "Saved map to compare with")
      .Required();
  AddEvaluate(line, command);

  CommandLine runs = Add(line, command, "compare-runs",
                         "The first frame at which two recorded runs part, and how; exit code 1 "
                         "when they do",
                         RunCompareRuns);
  runs.Option("LOG", &arguments.map, "Log of a run, with its MAP_COMMITs").Required();
  runs.Option("OTHER", &arguments.other_map, "Log to compare with").Required();
}

/// Commands for a running server.
void AddServerCommands(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  line.Option("--timeout", &arguments.timeout, "Seconds to wait for a running server").Positive();

  CommandLine follow = Add(
      line, command, "follow",
      "Keeps a copy of the running server's surface as a viewer does; Ctrl-C ends it", RunFollow);
  follow.Option("--out", &arguments.out, "PLY file to write the surface to in the end");
  follow.Option("--frames", &arguments.frames, "End once the map has so many frames; 0 = never")
      .AtLeast(0);

  Add(line, command, "digests",
      "Digests of the running server's free space and surface, and of what the exporter holds",
      RunDigests)
      .Flag("--json", &arguments.json, "As JSON");
  Add(line, command, "save", "Makes the running server save its map", RunSave)
      .Option("PATH", &arguments.out,
              "File on the server's computer; when not given, as the server is configured");
  AddWithMap(line, command, "load", "Makes the running server continue a saved map", RunLoad,
             "File on the server's computer");
  Add(line, command, "reset", "Makes the running server start an empty map", RunReset);
}

void AddCommands(CommandLine& line, Command* command) {
  MapToolArguments& arguments = command->arguments;
  AddWithMap(line, command, "info", "Facts of a map", RunInfo, kFileOrLive)
      .Flag("--json", &arguments.json, "As JSON");
  AddWithMap(line, command, "hash", "Hash of a map: equal maps, equal hashes", RunHash,
             kFileOrLive);
  CommandLine objects =
      AddWithMap(line, command, "objects", "The objects of a map", RunObjects, kFileOrLive);
  objects.Flag("--json", &arguments.json, "As JSON, discovered segments included");
  AddChoiceOfObjects(objects, "--id", &arguments);
  AddFileCommands(line, command);
  AddServerCommands(line, command);
}

}  // namespace

int main(int argc, char** argv) {
  Command command;
  ProcessSpec spec;
  spec.name = "map";
  spec.summary = "Looks at saved maps, and talks to a running map server.";
  spec.joins_bus = false;
  spec.add_options = [&](CommandLine& line) { AddCommands(line, &command); };
  UseConfig(&command.arguments.config, &spec);
  spec.run = [&](ProcessContext& context) { return command.run(command.arguments, context); };
  return RunProcess(argc, argv, spec);
}
