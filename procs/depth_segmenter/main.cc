#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "depth_segmenter/segmenter.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  std::optional<WaitForDetections> detections;
  std::optional<double> detection_timeout;
  ThreadOption threads;
  VismapConfig config;
};

void AddOptions(CLI::App& app, Arguments* arguments) {
  const std::map<std::string, WaitForDetections> policies = {
      {"required", WaitForDetections::kRequired},
      {"auto", WaitForDetections::kAuto},
      {"none", WaitForDetections::kNone}};
  app.add_option("--detections", arguments->detections,
                 "required: every frame waits for its own; auto: while a detector is alive; none; "
                 "overrides the config")
      ->transform(CLI::CheckedTransformer(policies))
      ->option_text("required|auto|none");
  app.add_option(
         "--detection-timeout", arguments->detection_timeout,
         "auto: seconds that a frame waits for a detector that is alive; overrides the config")
      ->check(CLI::PositiveNumber);
  arguments->threads.AddTo(app);
}

Result<std::string> Configure(const std::string& text, const std::string& path,
                              Arguments* arguments) {
  const Result<std::string> taken = TakeConfig(text, path, &arguments->config);
  if (!taken) return taken;
  DepthSegmenterConfig& section = arguments->config.depth_segmenter;
  section.detections = arguments->detections.value_or(section.detections);
  section.detection_timeout = arguments->detection_timeout.value_or(section.detection_timeout);
  return PrintConfig(arguments->config);
}

SegmenterOptions OptionsOf(const VismapConfig& config) {
  SegmenterOptions options;
  options.detections = config.depth_segmenter.detections;
  options.detection_timeout = config.depth_segmenter.detection_timeout;
  options.max_waiting = static_cast<size_t>(config.depth_segmenter.max_waiting_frames);
  options.stage = config.segmentation;
  return options;
}

Outcome Run(const Arguments& arguments, ProcessContext& context) {
  const std::unique_ptr<ThreadLimit> limit = arguments.threads.Limit();
  Segmenter(OptionsOf(arguments.config), &context).Run();
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "depth-segmenter";
  spec.summary = "Cuts depth images into segments and gives them the classes of detections.";
  spec.add_options = [&](CLI::App& app) { AddOptions(app, &arguments); };
  spec.configure = [&](const std::string& text, const std::string& path) {
    return Configure(text, path, &arguments);
  };
  spec.run = [&](ProcessContext& context) { return Run(arguments, context); };
  return RunProcess(argc, argv, spec);
}
