#include "runtime/main.h"

#include <cstdio>
#include <functional>
#include <memory>
#include <optional>

#include "base/file.h"
#include "base/format.h"
#include "base/printable.h"
#include "log_tool/convert.h"
#include "log_tool/cut.h"
#include "log_tool/map_to_mcap.h"
#include "log_tool/to_mcap.h"
#include "log_tool/verify.h"
#include "logs/recording.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  std::string input, out, format, detections;
  bool json = false;
  CutOptions cut;
  MapTopicOptions map;
  bool with_map = false;
  std::vector<std::string> channels;
  std::optional<int> camera;
  DatasetOptions frames;
  CalibrationOptions calibration;
  int camera_id = 0;
  VismapConfig config;
  std::function<Outcome(const Arguments&)> run;
  const StopSignal* stop = nullptr;
};

Outcome Unreadable(const Error& error) { return ExitWith(ExitCode::kUnreadable, error.message); }

Outcome Verify(const Arguments& arguments) {
  Result<LogReader> reader =
      LogReader::Open(arguments.input, arguments.config.pipeline.channel_prefix);
  if (!reader) return Unreadable(reader.error());
  const Result<LogReport> report = VerifyLog(*reader);
  if (!report) return Unreadable(report.error());
  const auto print = arguments.json ? ReportJson : ReportText;
  std::printf("%s", print(arguments.input, *report).c_str());
  const size_t problems = report->Problems().size();
  if (problems == 0) return {};
  return ExitWith(
      ExitCode::kFailed,
      arguments.input + ": " + FormatCount(static_cast<int64_t>(problems), "problem") + " found");
}

Outcome Cut(const Arguments& arguments) {
  Result<LogReader> reader =
      LogReader::Open(arguments.input, arguments.config.pipeline.channel_prefix);
  if (!reader) return Unreadable(reader.error());
  CutOptions options = arguments.cut;
  options.channels.insert(arguments.channels.begin(), arguments.channels.end());
  const Result<CutResult> cut = CutLog(*reader, options, arguments.out);
  if (!cut) return Unreadable(cut.error());
  if (cut->damaged_bytes > 0) {
    LogWarning(arguments.input + ": left out a damaged part of " + FormatBytes(cut->damaged_bytes));
  }
  std::printf("wrote %s with %s; left out %s\n", arguments.out.c_str(),
              FormatCount(cut->kept, "message").c_str(),
              FormatCount(cut->left_out, "message").c_str());
  return {};
}

// A sequence and its detections; nullptr when it has none or --detections is "none".
struct Sequence {
  Recording recording;
  std::unique_ptr<DetectionSource> detections;
};

Result<Sequence> OpenInput(const Arguments& arguments) {
  DatasetOptions options = arguments.frames;
  options.camera_id = CameraId{arguments.camera_id};
  Result<Recording> recording =
      OpenRecording(arguments.input, arguments.format, options, arguments.config.adapter,
                    arguments.config.pipeline.channel_prefix);
  if (!recording) return tl::unexpected(recording.error());
  for (const std::string& remark : recording->remarks) LogWarning(remark);
  for (const std::string& remark : recording->dataset->remarks()) LogInfo(remark);
  Sequence sequence{std::move(*recording), nullptr};
  const std::string path =
      arguments.detections.empty()
          ? sequence.recording.dataset->default_detections_path().value_or("none")
          : arguments.detections;
  if (path == "none") return sequence;
  Result<std::unique_ptr<DetectionSource>> detections =
      OpenRecordedDetections(path, arguments.config.pipeline.channel_prefix);
  if (!detections) return tl::unexpected(detections.error());
  sequence.detections = std::move(*detections);
  return sequence;
}

Outcome PrintResult(const Result<ConvertResult>& result, const std::string& out) {
  if (!result) return Unreadable(result.error());
  for (const std::string& lost : result->lost) LogWarning("not stored in " + out + ": " + lost);
  std::printf("wrote %s with %s\n", out.c_str(), FormatCount(result->frames, "frame").c_str());
  return {};
}

Outcome ToDataset(const Arguments& arguments) {
  const Result<Sequence> input = OpenInput(arguments);
  if (!input) return Unreadable(input.error());
  std::optional<CameraId> camera;
  if (arguments.camera) camera = CameraId{*arguments.camera};
  return PrintResult(
      WriteFolder(*input->recording.dataset, input->detections.get(), camera, arguments.out),
      arguments.out);
}

Outcome FromDataset(Arguments arguments) {
  if (const Result<void> set = arguments.calibration.SetIn(&arguments.frames); !set)
    return ExitWith(ExitCode::kUsage, set.error().message);
  const Result<Sequence> input = OpenInput(arguments);
  if (!input) return Unreadable(input.error());
  return PrintResult(WriteLog(*input->recording.dataset, input->detections.get(), arguments.out,
                              arguments.config.pipeline.channel_prefix),
                     arguments.out);
}

// What is told of an MCAP file besides its topics.
void WarnOfLosses(const Arguments& arguments, const McapExport& written) {
  if (written.damaged_bytes > 0)
    LogWarning(arguments.input + ": left out a damaged part of " +
               FormatBytes(written.damaged_bytes));
  if (written.unusable.total() > 0)
    LogWarning(arguments.input + ": " + FormatCount(written.unusable.total(), "message") +
               " cannot be used: " + written.unusable.Text());
  for (const std::string& remark : written.remarks) LogWarning(remark);
}

void PrintTopics(const Arguments& arguments, const McapExport& written) {
  int64_t messages = 0;
  for (const auto& [topic, count] : written.topics) messages += count;
  std::printf("wrote %s with %s, %s\n", arguments.out.c_str(),
              FormatCount(messages, "message").c_str(), FormatBytes(written.bytes).c_str());
  for (const auto& [topic, count] : written.topics)
    std::printf("  %-28s %8s\n", topic.c_str(), FormatCount(count).c_str());
  if (written.repeated > 0)
    std::printf("left out %s that were sent again\n",
                FormatCount(written.repeated, "message").c_str());
  for (const auto& [channel, count] : written.other_octrees)
    std::printf("left out %s of %s: /map/occupied and /map/free have their content\n",
                FormatCount(count, "message").c_str(), PrintableText(channel).c_str());
  for (const auto& [channel, count] : written.without_counterpart)
    std::printf("left out %s of %s, which has no counterpart\n",
                FormatCount(count, "message").c_str(), PrintableText(channel).c_str());
}

Result<McapExport> WriteSequence(const Arguments& arguments) {
  if (arguments.cut.from != 0 || arguments.cut.to || !arguments.channels.empty())
    return Fail(
        "--from, --to and --channels are for logs that are written without --map; "
        "vismap-log cut selects a part of a log");
  const Result<Sequence> input = OpenInput(arguments);
  if (!input) return tl::unexpected(input.error());
  return WriteMcap({*input->recording.dataset, input->detections.get(), arguments.with_map},
                   arguments.config, arguments.map, arguments.out, arguments.stop);
}

// Writes a log as it is, or the sequence of which a map is to be made.
Result<McapExport> WriteMcapOf(const Arguments& arguments) {
  const std::string file = arguments.input.substr(0, arguments.input.find('?'));
  if (const auto other = CheckIsNotInput(file, arguments.out); !other)
    return tl::unexpected(other.error());
  const bool has_parameters = file != arguments.input;
  if (arguments.with_map || has_parameters || !IsLog(arguments.input))
    return WriteSequence(arguments);
  Result<LogReader> reader =
      LogReader::Open(arguments.input, arguments.config.pipeline.channel_prefix);
  if (!reader) return tl::unexpected(reader.error());
  const Result<bool> foreign =
      HasForeignFramesOnly(*reader, arguments.config.adapter, arguments.stop);
  if (!foreign) return tl::unexpected(foreign.error());
  if (*foreign) return WriteSequence(arguments);
  McapExportOptions options{arguments.cut, arguments.map};
  options.cut.channels.insert(arguments.channels.begin(), arguments.channels.end());
  return WriteMcap(*reader, options, arguments.out, arguments.stop);
}

Outcome ToMcap(const Arguments& arguments) {
  const Result<McapExport> written = WriteMcapOf(arguments);
  if (!written && arguments.stop->requested())
    return ExitWith(ExitCode::kFailed, written.error().message);
  if (!written) return Unreadable(written.error());
  WarnOfLosses(arguments, *written);
  PrintTopics(arguments, *written);
  return {};
}

CommandLine Add(CommandLine& line, Arguments* arguments, const char* name, const char* help,
                const std::function<Outcome(const Arguments&)>& run) {
  return line.Command(name, help, [arguments, run] { arguments->run = run; });
}

void AddCut(CommandLine& line, Arguments* arguments) {
  CommandLine cut =
      Add(line, arguments, "cut", "Copy a part of a log, selected by time or channels", Cut);
  cut.Option("LOG", &arguments->input, "Log of LCM messages").Required();
  cut.Option("--out", &arguments->out, "Log to write").Required();
  cut.Option("--from", &arguments->cut.from, "Begin: seconds after the first message");
  cut.Option("--to", &arguments->cut.to, "End (exclusive): seconds after the first message");
  cut.Option("--channels", &arguments->channels, "Keep only these channels: NAME,NAME");
}

void AddToMcap(CommandLine& line, Arguments* arguments) {
  CommandLine to = Add(line, arguments, "to-mcap",
                       "Write a run as an MCAP file with Foxglove's schemas, which Foxglove, "
                       "Lichtblick and Rerun open",
                       ToMcap);
  to.Option("LOG", &arguments->input,
            "Log of LCM messages, also one of DimOS, Drake or bot_core; or any other sequence")
      .Required();
  to.Option("--out", &arguments->out, "MCAP file to write").Required();
  to.Flag("--map", &arguments->with_map,
          "Write only the frames and detections of the log, and map them; for logs without a map");
  to.Option("--from", &arguments->cut.from, "Begin: seconds after the first message");
  to.Option("--to", &arguments->cut.to, "End (exclusive): seconds after the first message");
  to.Option("--channels", &arguments->channels, "Use only these channels: NAME,NAME");
  to.Option("--changes-every", &arguments->map.changes_s,
            "Write changes of the surface at most once in so many seconds")
      .AtLeast(0);
  to.Option("--whole-every", &arguments->map.whole_s,
            "Write the whole surface as points, and free space, at most once in so many seconds")
      .AtLeast(0);
  to.Choice("--coloring", &arguments->map.coloring,
            {{"instance", Coloring::kInstance},
             {"class", Coloring::kClass},
             {"segment", Coloring::kSegment},
             {"rgb", Coloring::kRgb}},
            "Colours of the triangles");
}

void AddFromDataset(CommandLine& line, Arguments* arguments) {
  CommandLine from =
      Add(line, arguments, "from-dataset",
          "Write a recorded sequence as a log of RGBD_FRAME and DETECTIONS", FromDataset);
  from.Option("PATH", &arguments->input,
              "Folder of an RGB-D sequence with poses, log, synthetic:room or synthetic:office")
      .Required();
  from.Option("--out", &arguments->out, "Log to write").Required();
  from.Option("--format", &arguments->format,
              "Format of the folder; detected automatically if not given");
  from.Option("--detections", &arguments->detections,
              "COCO results file, folder of instance PNGs, log, or 'none'; if not given, those of "
              "the sequence");
  from.Option("--camera-id", &arguments->camera_id, "Camera id of all frames").AtLeast(0);
  from.Option("--stride", &arguments->frames.stride, "Use every n-th frame only").Positive();
  from.Option("--max-frames", &arguments->frames.max_frames, "Largest number of frames; 0 = all")
      .AtLeast(0);
  arguments->calibration.AddTo(from);
}

void AddConvert(CommandLine& line, Arguments* arguments) {
  CommandLine convert = Add(
      line, arguments, "convert",
      "Write the frames of a log of DimOS, Drake or bot_core as a log of RGBD_FRAME; options of "
      "the camera are in the section adapter of --config",
      FromDataset);
  convert.Option("LOG", &arguments->input, "Log of LCM messages").Required();
  convert.Option("--out", &arguments->out, "Log to write").Required();
  convert.Option("--stride", &arguments->frames.stride, "Use every n-th frame only").Positive();
  convert.Option("--max-frames", &arguments->frames.max_frames, "Largest number of frames; 0 = all")
      .AtLeast(0);
}

void AddCommands(CommandLine& line, Arguments* arguments) {
  CommandLine verify = Add(line, arguments, "verify",
                           "Check a log for lost messages, wrong types, checksums and damage, and "
                           "print counts and rates; exit code 1 if there are problems",
                           Verify);
  verify.Option("LOG", &arguments->input, "Log of LCM messages").Required();
  verify.Flag("--json", &arguments->json, "Print JSON");

  AddCut(line, arguments);

  CommandLine to = Add(
      line, arguments, "to-dataset",
      "Write the frames of a log as a folder of images, poses and detections in SceneNN's format",
      ToDataset);
  to.Option("LOG", &arguments->input,
            "Log of LCM messages; run.lcmlog?frames=all also uses frames without a commit")
      .Required();
  to.Option("--out", &arguments->out, "Folder to write").Required();
  to.Option("--camera", &arguments->camera, "Camera id to use if the log has several cameras");

  AddToMcap(line, arguments);
  AddFromDataset(line, arguments);
  AddConvert(line, arguments);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "log";
  spec.summary = "Verifies, cuts and converts logs of LCM messages.";
  spec.joins_bus = false;
  spec.add_options = [&](CommandLine& line) { AddCommands(line, &arguments); };
  UseConfig(&arguments.config, &spec);
  spec.run = [&](ProcessContext& context) {
    arguments.stop = &context.stop;
    return arguments.run(arguments);
  };
  return RunProcess(argc, argv, spec);
}
