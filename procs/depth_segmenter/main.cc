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
  DepthSegmenterConfig& config = arguments->config.depth_segmenter;
  line.Choice("--detections", &config.detections,
              {{"required", WaitForDetections::kRequired},
               {"auto", WaitForDetections::kAuto},
               {"none", WaitForDetections::kNone}},
              "required: every frame waits for its detections; auto: it waits while a detector is "
              "alive; none: no detections");
  line.Option("--detection-timeout", &config.detection_timeout,
              "auto: seconds that a frame waits while a detector is alive")
      .Positive();
  arguments->threads.AddTo(line);
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
  spec.summary = "Segments depth images and assigns the classes of the detections to the segments.";
  spec.add_options = [&](CommandLine& line) { AddOptions(line, &arguments); };
  UseConfig(&arguments.config, &spec);
  spec.run = [&](ProcessContext& context) { return Run(arguments, context); };
  return RunProcess(argc, argv, spec);
}
