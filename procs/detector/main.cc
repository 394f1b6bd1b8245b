#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "detector/choose_backend.h"
#include "detector/live_detector.h"
#include "detector/recorded_detector.h"
#include "detector/write_detections.h"
#include "logs/recording.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  std::string dataset, format, detections, out;
  VismapConfig config;
  bool check = false;
  DetectorBackend chosen = DetectorBackend::kAuto;
  std::unique_ptr<DetectionSource> source;  // recorded
  std::unique_ptr<DnnDetector> network;     // dnn
};

void AddNetworkOptions(CommandLine& line, Arguments* arguments) {
  DetectorOptions& config = arguments->config.detector;
  line.Option("--model", &config.dnn.model,
              "dnn: ONNX file of a YOLO segmentation network, or frozen graph (.pb) of Mask R-CNN");
  line.Option("--graph", &config.dnn.graph, "dnn: text file (.pbtxt) of the frozen graph");
  line.Option("--threads", &config.dnn.threads, "dnn: number of threads; 0 = all processors")
      .Range(0, 1024);
  line.Option(
          "--out", &arguments->out,
          "dnn: run on --dataset without a bus, and write the detections to this COCO results file")
      .Needs("--dataset");
  line.Flag("--every-frame", &config.every_frame,
            "dnn: run on every frame, even if the detector falls behind; by default it runs on the "
            "newest frame");
}

void AddOptions(CommandLine& line, Arguments* arguments) {
  DetectorOptions& config = arguments->config.detector;
  line.Choice(
      "--backend", &config.backend,
      "recorded: detections from files; dnn: a network; auto: depends on the given options");
  line.Option("--detections", &arguments->detections,
              "COCO results file, folder of instance PNGs, log of LCM messages, synthetic:room or "
              "synthetic:office");
  line.Option("--dataset", &arguments->dataset,
              "Sequence whose own detections are used if --detections is not given");
  line.Option("--format", &arguments->format,
              "Format of the folder; detected automatically if not given");
  line.Flag("--check", &arguments->check,
            "Only check that the detections or the network can be read; needs no bus");
  line.Option("--camera-id", &config.camera_id,
              "Process frames of this camera only; -1 = all cameras")
      .Range(-1, 1 << 30);
  AddNetworkOptions(line, arguments);
}

Result<std::string> DetectionsPath(const Arguments& arguments) {
  if (!arguments.detections.empty()) return arguments.detections;
  if (arguments.dataset.empty()) return Fail("--detections or --dataset is missing");
  const auto recording = OpenRecording(arguments.dataset, arguments.format, {}, {},
                                       arguments.config.pipeline.channel_prefix);
  if (!recording) return tl::unexpected(recording.error());
  const std::optional<std::string> path = recording->dataset->default_detections_path();
  if (!path)
    return Fail(arguments.dataset +
                ": the sequence has no detections, and --detections was not given");
  return *path;
}

Outcome OpenRecorded(Arguments* arguments) {
  const Result<std::string> path = DetectionsPath(*arguments);
  if (!path) return ExitWith(ExitCode::kUnreadable, path.error().message);
  auto source = OpenRecordedDetections(*path, arguments->config.pipeline.channel_prefix);
  if (!source) return ExitWith(ExitCode::kUnreadable, source.error().message);
  arguments->source = std::move(*source);
  return {};
}

Outcome OpenNetwork(Arguments* arguments) {
  auto network = DnnDetector::Load(arguments->config.detector.dnn);
  if (!network) return ExitWith(ExitCode::kUnreadable, network.error().message);
  arguments->network = std::move(*network);
  return {};
}

Outcome Open(Arguments* arguments) {
  // With --out the network runs on the sequence.
  const bool names_recording =
      !arguments->detections.empty() || (!arguments->dataset.empty() && arguments->out.empty());
  if (!arguments->out.empty() && names_recording)
    return ExitWith(
        ExitCode::kUsage,
        "--out stores the detections of a network and cannot be used with --detections");
  const auto chosen = ChooseBackend(arguments->config.detector, names_recording);
  if (!chosen) return ExitWith(ExitCode::kUsage, chosen.error().message);
  arguments->chosen = *chosen;
  return *chosen == DetectorBackend::kDnn ? OpenNetwork(arguments) : OpenRecorded(arguments);
}

Outcome Write(const Arguments& arguments, const StopSignal& stop) {
  const auto recording = OpenRecording(arguments.dataset, arguments.format, {}, {},
                                       arguments.config.pipeline.channel_prefix);
  if (!recording) return ExitWith(ExitCode::kUnreadable, recording.error().message);
  return WriteDetections(*recording->dataset, arguments.network.get(), arguments.out, stop);
}

Outcome Run(const Arguments& arguments, ProcessContext& context) {
  if (arguments.check) return {};
  if (!arguments.out.empty()) return Write(arguments, context.stop);
  if (arguments.chosen == DetectorBackend::kRecorded)
    return RunRecordedDetector(*arguments.source, arguments.config.detector.camera_id, context);
  LiveDetector(arguments.config.detector, arguments.network.get(), &context).Run();
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "detector";
  spec.summary =
      "Publishes the objects in every frame, from recorded detections or from a network.";
  spec.add_options = [&](CommandLine& line) { AddOptions(line, &arguments); };
  UseConfig(&arguments.config, &spec);
  spec.prepare = [&] {
    spec.joins_bus = !arguments.check && arguments.out.empty();
    return Open(&arguments);
  };
  spec.run = [&](ProcessContext& context) { return Run(arguments, context); };
  return RunProcess(argc, argv, spec);
}
