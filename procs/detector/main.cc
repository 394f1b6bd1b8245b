#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "detector/detect.h"
#include "logs/recording.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  std::string dataset, format, detections;
  std::optional<int> camera_id;
  VismapConfig config;
  bool check = false;
  std::unique_ptr<DetectionSource> source;
};

void AddOptions(CLI::App& app, Arguments* arguments) {
  app.add_option("--detections", arguments->detections,
                 "COCO results file, folder of instance PNGs, log of LCM messages, synthetic:room "
                 "or synthetic:office");
  app.add_option("--dataset", arguments->dataset,
                 "Sequence whose own detections are taken when --detections is absent");
  app.add_option("--format", arguments->format,
                 "Layout of the sequence's folder; found by looking when not given");
  app.add_flag("--check", arguments->check,
               "Only see whether the detections can be read; needs no bus");
  app.add_option("--camera-id", arguments->camera_id,
                 "Answer frames of this camera only; -1 = of all")
      ->check(CLI::Range(-1, 1 << 30));
}

Result<std::string> DetectionsPath(const Arguments& arguments) {
  if (!arguments.detections.empty()) return arguments.detections;
  if (arguments.dataset.empty()) return Fail("expected --detections or --dataset");
  const auto recording = OpenRecording(arguments.dataset, arguments.format);
  if (!recording) return tl::unexpected(recording.error());
  const std::optional<std::string> path = recording->dataset->default_detections_path();
  if (!path)
    return Fail(arguments.dataset +
                ": has no detections of its own, and --detections was not given");
  return *path;
}

Outcome Open(Arguments* arguments) {
  if (arguments->detections.empty() && arguments->dataset.empty()) {
    return ExitWith(ExitCode::kUsage, "expected --detections or --dataset");
  }
  const Result<std::string> path = DetectionsPath(*arguments);
  if (!path) return ExitWith(ExitCode::kUnreadable, path.error().message);
  auto source = OpenRecordedDetections(*path);
  if (!source) return ExitWith(ExitCode::kUnreadable, source.error().message);
  arguments->source = std::move(*source);
  return {};
}

// The command line goes before the config.
Result<std::string> Configure(const std::string& text, const std::string& path,
                              Arguments* arguments) {
  const Result<std::string> taken = TakeConfig(text, path, &arguments->config);
  if (!taken) return taken;
  DetectorConfig& section = arguments->config.detector;
  section.camera_id = arguments->camera_id.value_or(section.camera_id);
  return PrintConfig(arguments->config);
}

std::optional<CameraId> Camera(const Arguments& arguments) {
  const int id = arguments.config.detector.camera_id;
  return id < 0 ? std::nullopt : std::optional(CameraId{id});
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "detector";
  spec.summary = "Answers every frame with recorded detections, as a detector would.";
  spec.add_options = [&](CLI::App& app) { AddOptions(app, &arguments); };
  spec.configure = [&](const std::string& text, const std::string& path) {
    return Configure(text, path, &arguments);
  };
  spec.prepare = [&] {
    spec.joins_bus = !arguments.check;
    return Open(&arguments);
  };
  spec.run = [&](ProcessContext& context) -> Outcome {
    if (arguments.check) return {};
    return Detect(*arguments.source, Camera(arguments), context);
  };
  return RunProcess(argc, argv, spec);
}
