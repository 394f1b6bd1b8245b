#include "evaluate/evaluate_map.h"

namespace {

using namespace vismap;

void AddOptions(CommandLine& line, EvaluateArguments* arguments) {
  line.Option("--gt", &arguments->ground_truth,
              "Folder with the ground truth of a SceneNN or ScanNet sequence, or synthetic:room")
      .Required();
  line.Option("--map", &arguments->map, "Saved map (.vismap), or mesh with ids (.ply)").Required();
  line.Option(
      "--objects", &arguments->objects,
      "objects.json with the scores of a mesh; if not given, the one in the folder of the mesh");
  line.Option("--classes", &arguments->classes,
              "paper (the nine classes of the paper), scene (all classes of the ground truth), or "
              "COCO names separated by commas; if not given, paper, but scene for synthetic:room");
  line.Flag("--json", &arguments->json, "Print JSON, which also has what --why prints");
  line.Flag("--why", &arguments->why,
            "After the scores, print what became of each true object and what swallowed it");
  line.Option("--out", &arguments->out, "Also write the JSON to this file");
}

}  // namespace

int main(int argc, char** argv) {
  EvaluateArguments arguments;
  ProcessSpec spec;
  spec.name = "evaluate";
  spec.summary = "Evaluates a map against a ground truth: surface, objects and free space.";
  spec.joins_bus = false;
  spec.add_options = [&](CommandLine& line) { AddOptions(line, &arguments); };
  UseConfig(&arguments.config, &spec);
  spec.run = [&](ProcessContext&) { return RunEvaluate(arguments); };
  return RunProcess(argc, argv, spec);
}
