#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "logs/recording.h"
#include "sensor_replay/replay.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  std::string dataset, format;
  int camera_id = 0;
  DatasetOptions sequence;
  ReplayOptions replay;  // but for what the config says, too
  std::optional<std::string> mode;
  std::optional<double> speed, resend_after;
  std::optional<int> window;
  VismapConfig config;
  std::unique_ptr<Dataset> opened;
};

void AddOptions(CLI::App& app, Arguments* arguments) {
  DatasetOptions& sequence = arguments->sequence;
  ReplayOptions& replay = arguments->replay;
  app.add_option(
         "--dataset", arguments->dataset,
         "Folder of the sequence, a log of LCM messages, synthetic:room or synthetic:office")
      ->required();
  app.add_option("--format", arguments->format,
                 "Layout of the folder; found by looking when not given");
  app.add_option(
         "--mode", arguments->mode,
         "realtime, or lockstep: at the pace of the map server; a log is played in lockstep "
         "unless you say otherwise")
      ->check(CLI::IsMember({"realtime", "lockstep"}));
  app.add_option("--speed", arguments->speed, "Of real time; 0 = as fast as possible")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--window", arguments->window,
                 "Lockstep: frames sent before the oldest is committed")
      ->check(CLI::Range(1, 1000));
  app.add_option("--resend-s", arguments->resend_after,
                 "Lockstep: seconds without a commit before frames are repeated")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--wait-for", replay.wait_for,
                 "Programs that must be ready first: depth-segmenter,map-server")
      ->delimiter(',');
  app.add_flag("--loop", replay.loop, "Begin again at the end, with utimes that go on");
  app.add_option("--camera-id", arguments->camera_id,
                 "Given to every frame; those of a log keep theirs")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--stride", sequence.stride, "Every n-th frame")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--max-frames", sequence.max_frames, "At most so many frames; 0 = all")
      ->check(CLI::NonNegativeNumber);
}

// The command line goes before the config.
Result<std::string> Configure(const std::string& text, const std::string& path,
                              Arguments* arguments) {
  const Result<std::string> taken = TakeConfig(text, path, &arguments->config);
  if (!taken) return taken;
  SensorReplayConfig& section = arguments->config.sensor_replay;
  if (IsLog(arguments->dataset)) section.lockstep = true;
  if (arguments->mode) section.lockstep = *arguments->mode == "lockstep";
  section.speed = arguments->speed.value_or(section.speed);
  section.window = arguments->window.value_or(section.window);
  section.resend_after = arguments->resend_after.value_or(section.resend_after);
  arguments->replay.lockstep = section.lockstep;
  arguments->replay.speed = section.speed;
  arguments->replay.window = section.window;
  arguments->replay.resend_after = section.resend_after;
  return PrintConfig(arguments->config);
}

Outcome Open(Arguments* arguments) {
  arguments->sequence.camera_id = CameraId{arguments->camera_id};
  auto recording = OpenRecording(arguments->dataset, arguments->format, arguments->sequence);
  if (!recording) return ExitWith(ExitCode::kUnreadable, recording.error().message);
  for (const std::string& remark : recording->remarks) LogWarning(remark);
  arguments->opened = std::move(recording->dataset);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "sensor-replay";
  spec.summary = "Publishes the frames of a recorded or synthetic RGB-D sequence.";
  spec.add_options = [&](CLI::App& app) { AddOptions(app, &arguments); };
  spec.configure = [&](const std::string& text, const std::string& path) {
    return Configure(text, path, &arguments);
  };
  spec.prepare = [&] { return Open(&arguments); };
  spec.run = [&](ProcessContext& context) {
    return Replay(*arguments.opened, arguments.replay, context);
  };
  return RunProcess(argc, argv, spec);
}
