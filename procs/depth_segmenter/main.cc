#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <string>

#include "base/parallel.h"
#include "depth_segmenter/segmenter.h"

namespace {

using namespace vismap;

struct Arguments {
  int threads = 0;
  SegmenterOptions segmenter;
};

void AddOptions(CLI::App& app, Arguments* arguments) {
  const std::map<std::string, DetectionPolicy> policies = {{"required", DetectionPolicy::kRequired},
                                                           {"auto", DetectionPolicy::kAuto},
                                                           {"none", DetectionPolicy::kNone}};
  app.add_option(
         "--detections", arguments->segmenter.detections,
         "required: every frame waits for its own; auto (default): while a detector is alive; none")
      ->transform(CLI::CheckedTransformer(policies))
      ->option_text("required|auto|none");
  app.add_option("--detection-timeout", arguments->segmenter.detection_timeout,
                 "auto: seconds that a frame waits for a detector that is alive")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--threads", arguments->threads, "Threads to use; 0 = all processors")
      ->check(CLI::NonNegativeNumber);
}

Outcome Run(const Arguments& arguments, ProcessContext& context) {
  std::unique_ptr<ThreadLimit> limit;
  if (arguments.threads > 0) limit = std::make_unique<ThreadLimit>(arguments.threads);
  Segmenter(arguments.segmenter, &context).Run();
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "depth-segmenter";
  spec.summary = "Cuts depth images into segments and gives them the classes of detections.";
  spec.add_options = [&](CLI::App& app) { AddOptions(app, &arguments); };
  spec.run = [&](ProcessContext& context) { return Run(arguments, context); };
  return RunProcess(argc, argv, spec);
}
