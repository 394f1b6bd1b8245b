#include <memory>

#include "depth_segmenter/segmenter.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  ThreadOption threads;
  VismapConfig config;
};

void AddOptions(CommandLine& line, Arguments* arguments) {
  DepthSegmenterOptions& config = arguments->config.depth_segmenter;
  line.Choice("--detections", &config.detections,
              "required: every frame waits for its detections; auto: it waits while a detector is "
              "alive; none: no detections");
  line.Option("--detection-timeout", &config.detection_timeout_s,
              "auto: seconds that a frame waits while a detector is alive")
      .Positive();
  arguments->threads.AddTo(line);
}

Outcome Run(const Arguments& arguments, ProcessContext& context) {
  const std::unique_ptr<ThreadLimit> limit = arguments.threads.Limit();
  const VismapConfig& config = arguments.config;
  Segmenter(config.depth_segmenter, config, &context).Run();
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "depth-segmenter";
  spec.summary = "Segments depth images and assigns the classes of the detections to the segments.";
  spec.add_options = [&](CommandLine& line) { AddOptions(line, &arguments); };
  UseConfig(&arguments.config, &spec);
  spec.run = [&](ProcessContext& context) { return Run(arguments, context); };
  return RunProcess(argc, argv, spec);
}
