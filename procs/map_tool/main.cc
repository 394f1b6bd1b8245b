#include <CLI/CLI.hpp>
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

CLI::App* Add(CLI::App& app, Command* command, const char* name, const char* help,
              Outcome (*run)(const MapToolArguments&, ProcessContext&)) {
  CLI::App* sub = app.add_subcommand(name, help);
  sub->callback([command, run] { command->run = run; });
  return sub;
}

void AddEvaluate(CLI::App& app, Command* command) {
  MapToolArguments& arguments = command->arguments;
  CLI::App* sub =
      Add(app, command, "evaluate", "How good a map is, against a ground truth", RunEvaluate);
  sub->add_option(
         "--gt", arguments.ground_truth,
         "Folder with the ground truth of a SceneNN or ScanNet sequence, or synthetic:room")
      ->required();
  sub->add_option("--map", arguments.map, "Saved map (.vismap), or mesh with ids (.ply)")
      ->required();
  sub->add_option("--objects", arguments.objects,
                  "objects.json of a mesh, for the scores; default: the one beside it");
  sub->add_option("--classes", arguments.classes,
                  "paper (its nine), scene (all that the ground truth has), or COCO names with "
                  "commas between; default: paper, for synthetic:room scene");
  sub->add_flag("--json", arguments.json, "Print JSON");
  sub->add_option("--out", arguments.out, "Write the JSON to this file, too");
}

void AddCommands(CLI::App& app, Command* command) {
  MapToolArguments& arguments = command->arguments;
  const auto takes_map = [&](CLI::App* sub, const char* help) {
    sub->add_option("MAP", arguments.map, help)->required();
  };
  const char* kFileOrLive = "Saved map (.vismap), or live: the one of the running server";
  app.require_subcommand(1);
  app.fallthrough();
  app.add_option("--timeout", arguments.timeout, "Seconds to wait for a running server")
      ->check(CLI::PositiveNumber);

  CLI::App* info = Add(app, command, "info", "Facts of a map", RunInfo);
  takes_map(info, kFileOrLive);
  info->add_flag("--json", arguments.json, "As JSON");
  takes_map(Add(app, command, "hash", "Hash of a map: equal maps, equal hashes", RunHash),
            kFileOrLive);
  CLI::App* objects = Add(app, command, "objects", "The objects of a map", RunObjects);
  takes_map(objects, kFileOrLive);
  objects->add_flag("--json", arguments.json, "As JSON, discovered segments included");
  objects->add_option("--id", arguments.id, "Only this: an instance (7) or a segment (s12)");
  objects->add_option("--class", arguments.class_name, "Only this class: COCO name or id");
  objects->add_option("--region", arguments.region,
                      "Only what reaches into the box x0,y0,z0,x1,y1,z1 [m]");

  CLI::App* files = Add(
      app, command, "export",
      "Mesh, objects, octrees and picture of a saved map, into a folder; with --object, --class "
      "or --region only mesh (.ply) and points (.xyz) of these objects",
      RunExport);
  takes_map(files, "Saved map (.vismap)");
  files->add_option("--out", arguments.out, "Folder for the results")->required();
  files->add_option("--object", arguments.id, "Only this: an instance (7) or a segment (s12)");
  files->add_option("--class", arguments.class_name, "Only this class: COCO name or id");
  files->add_option("--region", arguments.region,
                    "Only what reaches into the box x0,y0,z0,x1,y1,z1 [m]");
  CLI::App* render = Add(app, command, "render", "A picture of a saved map", RunRender);
  takes_map(render, "Saved map (.vismap)");
  render->add_option("--out", arguments.out, "PNG file")->required();
  render->add_option("--color", arguments.coloring, "instance, class, segment or rgb")
      ->check(CLI::IsMember({"instance", "class", "segment", "rgb"}));
  render->add_option("--view", arguments.view, "overview (with legend), perspective or top")
      ->check(CLI::IsMember({"overview", "perspective", "top"}));
  CLI::App* diff =
      Add(app, command, "diff", "In what two saved maps differ; exit code 1 when they do", RunDiff);
  takes_map(diff, "Saved map (.vismap)");
  diff->add_option("OTHER", arguments.other_map, "Saved map to compare with")->required();

  AddEvaluate(app, command);

  CLI::App* follow = Add(
      app, command, "follow",
      "Keeps a copy of the running server's surface as a viewer does; Ctrl-C ends it", RunFollow);
  follow->add_option("--out", arguments.out, "PLY file to write the surface to in the end");
  follow->add_option("--frames", arguments.frames, "End once the map has so many frames; 0 = never")
      ->check(CLI::NonNegativeNumber);

  Add(app, command, "digests",
      "Digests of the running server's free space and surface, and of what the exporter holds",
      RunDigests)
      ->add_flag("--json", arguments.json, "As JSON");

  CLI::App* runs = Add(app, command, "compare-runs",
                       "The first frame at which two recorded runs part, and how; exit code 1 when "
                       "they do",
                       RunCompareRuns);
  runs->add_option("LOG", arguments.map, "Log of a run, with its MAP_COMMITs")->required();
  runs->add_option("OTHER", arguments.other_map, "Log to compare with")->required();

  Add(app, command, "save", "Makes the running server save its map", RunSave)
      ->add_option("PATH", arguments.out,
                   "File on the server's computer; default: as the server is configured");
  takes_map(Add(app, command, "load", "Makes the running server continue a saved map", RunLoad),
            "File on the server's computer");
  Add(app, command, "reset", "Makes the running server start an empty map", RunReset);
}

}  // namespace

int main(int argc, char** argv) {
  Command command;
  ProcessSpec spec;
  spec.name = "map";
  spec.summary = "Looks at saved maps, and talks to a running map server.";
  spec.joins_bus = false;
  spec.add_options = [&](CLI::App& app) { AddCommands(app, &command); };
  spec.configure = [&](const std::string& text, const std::string& path) {
    return TakeConfig(text, path, &command.arguments.config);
  };
  spec.run = [&](ProcessContext& context) { return command.run(command.arguments, context); };
  return RunProcess(argc, argv, spec);
}
