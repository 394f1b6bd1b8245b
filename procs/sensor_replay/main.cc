#include "runtime/main.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>

#include "sensor_replay/replay.h"
#include "simulation/sequence.h"

namespace {

using namespace vismap;

struct Arguments {
  std::string dataset, format, mode = "realtime";
  int camera_id = 0;
  DatasetOptions sequence;
  ReplayOptions replay;
  std::unique_ptr<Dataset> opened;
};

void AddOptions(CLI::App& app, Arguments* arguments) {
  DatasetOptions& sequence = arguments->sequence;
  ReplayOptions& replay = arguments->replay;
  app.add_option("--dataset", arguments->dataset, "Folder of the sequence, or synthetic:room")
      ->required();
  app.add_option("--format", arguments->format,
                 "Layout of the folder; found by looking when not given");
  app.add_option("--mode", arguments->mode, "realtime, or lockstep: at the pace of the map server")
      ->check(CLI::IsMember({"realtime", "lockstep"}))
      ->capture_default_str();
  app.add_option("--speed", replay.speed, "Of real time; 0 = as fast as possible")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--window", replay.window, "Lockstep: frames sent before the oldest is committed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--resend-s", replay.resend_after,
                 "Lockstep: seconds without a commit before frames are repeated")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--wait-for", replay.wait_for,
                 "Programs that must be ready first: depth-segmenter,map-server")
      ->delimiter(',');
  app.add_flag("--loop", replay.loop, "Begin again at the end, with utimes that go on");
  app.add_option("--camera-id", arguments->camera_id, "Given to every frame")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--stride", sequence.stride, "Every n-th frame")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--max-frames", sequence.max_frames, "At most so many frames; 0 = all")
      ->check(CLI::NonNegativeNumber);
}

Outcome Open(Arguments* arguments) {
  arguments->sequence.camera_id = CameraId{arguments->camera_id};
  arguments->replay.lockstep = arguments->mode == "lockstep";
  auto dataset = OpenSequence(arguments->dataset, arguments->format, arguments->sequence);
  if (!dataset) return ExitWith(ExitCode::kUnreadable, dataset.error().message);
  arguments->opened = std::move(*dataset);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "sensor-replay";
  spec.summary = "Publishes the frames of a recorded or synthetic RGB-D sequence.";
  spec.add_options = [&](CLI::App& app) { AddOptions(app, &arguments); };
  spec.prepare = [&] { return Open(&arguments); };
  spec.run = [&](ProcessContext& context) {
    return Replay(*arguments.opened, arguments.replay, context);
  };
  return RunProcess(argc, argv, spec);
}
