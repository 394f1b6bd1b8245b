#include <memory>
#include <string>
#include <utility>

#include "logs/check_recording.h"
#include "logs/recording.h"
#include "sensor_replay/replay.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  std::string dataset, format;
  int camera_id = 0;
  DatasetOptions sequence;
  CalibrationOptions calibration;
  ReplayBounds bounds;
  VismapConfig config;
  std::unique_ptr<Dataset> opened;
};

void AddInput(CommandLine& line, Arguments* arguments) {
  DatasetOptions& sequence = arguments->sequence;
  line.Option("--dataset", &arguments->dataset,
              "Folder of a sequence, log of LCM messages, synthetic:room or synthetic:office")
      .Required();
  line.Option("--format", &arguments->format,
              "Format of the folder; detected automatically if not given");
  line.Option("--camera-id", &arguments->camera_id,
              "Camera id of all frames; frames of a log keep their own")
      .AtLeast(0);
  line.Option("--stride", &sequence.stride, "Use every n-th frame only").Positive();
  line.Option("--max-frames", &sequence.max_frames, "Largest number of frames; 0 = all").AtLeast(0);
  arguments->calibration.AddTo(line);
}

void AddOptions(CommandLine& line, Arguments* arguments) {
  AddInput(line, arguments);
  SensorReplayOptions& config = arguments->config.sensor_replay;
  line.Choice("--mode", &config.lockstep, {{"realtime", false}, {"lockstep", true}},
              "realtime: as recorded; lockstep: wait for the commits of the map server; logs use "
              "lockstep by default");
  line.Option("--speed", &config.speed, "Speed relative to real time; 0 = as fast as possible")
      .AtLeast(0);
  line.Option("--window", &config.window_frames,
              "Lockstep: largest number of sent frames that are not committed yet")
      .Range(1, 1000);
  line.Option("--resend-s", &config.resend_s,
              "Lockstep: seconds without a commit after which frames are sent again")
      .Positive();
  line.Option(
      "--wait-for", &arguments->bounds.wait_for,
      "Programs that must be ready before the first frame, for example depth-segmenter,map-server");
  line.Flag("--loop", &arguments->bounds.loop, "Start again at the end, with increasing utimes");
}

// A log is replayed in lockstep unless the command line requests another mode; the config file does
// not count.
Result<void> ReadOptions(const std::string& text, const std::string& path, Arguments* arguments) {
  const Result<void> read = ReadConfig(text, path, &arguments->config);
  if (IsLog(arguments->dataset)) arguments->config.sensor_replay.lockstep = true;
  return read;
}

void TellFindings(const Dataset& dataset, const VismapConfig& config) {
  const IntegrationOptions& options = config.integration;
  const RecordingCheck check = CheckRecording(dataset, {options.min_range_m, options.max_range_m},
                                              config.surface, CheckedFrames::kAFewDozen);
  for (const std::string& finding : check.findings) LogWarning(finding);
}

Outcome Open(Arguments* arguments) {
  arguments->sequence.camera_id = CameraId{arguments->camera_id};
  auto recording = OpenRecording(arguments->dataset, arguments->format, arguments->sequence,
                                 arguments->config.adapter, arguments->config.pipeline.channel_prefix);
  if (!recording) return ExitWith(ExitCode::kUnreadable, recording.error().message);
  for (const std::string& remark : recording->remarks) LogWarning(remark);
  for (const std::string& remark : recording->dataset->remarks()) LogInfo(remark);
  if (recording->dataset->size() == 0)
    return ExitWith(ExitCode::kUnreadable, arguments->dataset + ": no usable frames");
  if (recording->dataset->format() != "synthetic")  // which is right
    TellFindings(*recording->dataset, arguments->config);
  arguments->opened = std::move(recording->dataset);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "sensor-replay";
  spec.summary = "Publishes the frames of a recorded or synthetic RGB-D sequence.";
  spec.add_options = [&](CommandLine& line) { AddOptions(line, &arguments); };
  UseConfig(&arguments.config, &spec,
            [&] { return arguments.calibration.SetIn(&arguments.sequence); });
  spec.read_config = [&](const std::string& text, const std::string& path) {
    return ReadOptions(text, path, &arguments);
  };
  spec.prepare = [&] { return Open(&arguments); };
  spec.run = [&](ProcessContext& context) {
    return Replay(*arguments.opened, arguments.config.sensor_replay, arguments.bounds, context);
  };
  return RunProcess(argc, argv, spec);
}
