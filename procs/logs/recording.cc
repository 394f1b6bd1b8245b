#include "logs/recording.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "base/format.h"
#include "base/reason_counts.h"
#include "logs/foreign_dataset.h"
#include "logs/log_dataset.h"
#include "simulation/sequence.h"
#include "simulation/synthetic_dataset.h"

namespace vismap {
namespace {

struct LogPath {
  std::string file;
  bool all = false;      ///< ?frames=all
  bool foreign = false;  ///< ?frames=foreign
};

Result<LogPath> ParseLogPath(const std::string& path) {
  const size_t question = path.find('?');
  if (question == std::string::npos) return LogPath{path};
  const std::string parameter = path.substr(question + 1);
  if (parameter != "frames=all" && parameter != "frames=committed" &&
      parameter != "frames=foreign") {
    return Fail(path + ": unknown parameter \"" + parameter +
                "\"; expected frames=all, frames=committed or frames=foreign");
  }
  return LogPath{path.substr(0, question), parameter == "frames=all",
                 parameter == "frames=foreign"};
}

// run.lcmlog, or run.lcmlog.03 as lcm-logger --increment names them.
bool HasLogName(std::string_view file) {
  constexpr std::string_view kSuffix = ".lcmlog";
  const size_t last_dot = file.rfind('.');
  if (last_dot == std::string_view::npos) return false;
  const std::string_view ending = file.substr(last_dot + 1);
  const bool numbered =
      std::all_of(ending.begin(), ending.end(), [](char c) { return c >= '0' && c <= '9'; });
  return file.ends_with(kSuffix) || (numbered && file.substr(0, last_dot).ends_with(kSuffix));
}

bool BeginsAsLog(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    return false;  // reading from a pipe would consume its data
  std::array<char, 4> bytes{};
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(bytes.data(), bytes.size())) return false;
  uint32_t word = 0;
  for (const char byte : bytes) word = (word << 8) | static_cast<uint8_t>(byte);
  return word == kLogSyncWord;
}

Result<void> CheckLogOptions(const std::string& path, const DatasetOptions& options) {
  if (const auto checked = CheckOptions(options); !checked) return checked;
  if (options.registration == DepthRegistration::kKinect) {
    return Fail(path +
                ": the depth of a log is registered to colour already; depth of a Kinect can "
                "be registered in folders only (--depth-registration)");
  }
  if (Raw(options.camera_id) == 0) return {};
  return Fail(path +
              ": the frames of a log keep their camera ids, so no other camera id can be given");
}

// Intrinsics of the options must be possible for the images of all frames.
Result<void> CheckIntrinsics(const DatasetOptions& options,
                             const std::vector<RecordedFrame>& frames) {
  if (!options.intrinsics) return {};
  const auto& [fx, fy, cx, cy] = *options.intrinsics;
  for (const RecordedFrame& frame : frames) {
    const PinholeCamera& recorded = frame.header.camera;
    const auto checked = ValidateCamera({recorded.width, recorded.height, fx, fy, cx, cy});
    if (!checked) return Fail("--intrinsics: " + checked.error().message);
  }
  return {};
}

std::string WhyNoFrames(const RecordedRun& run, const FrameSelection& selection) {
  if (run.frames.empty() && run.unusable_frames.empty() && !run.other_frames.empty()) {
    const size_t prefix = run.other_frames.size() - std::string(kRgbdFrameChannel.name).size();
    return "the log has frames on the channel " + run.other_frames +
           "; to read them, give --channel-prefix '" + run.other_frames.substr(0, prefix) + "'";
  }
  if (run.frames.empty() && run.unusable_frames.empty())
    return "the log has no RGBD_FRAME, and no channels of DimOS, Drake or bot_core";
  ReasonCounts reasons;
  for (const SkippedFrame& skipped : selection.skipped) reasons.Add(skipped.reason);
  const std::string text = NoUsableFramesText(reasons, reasons.total());
  if (run.frames.empty()) return text;
  return text + "; add ?frames=all to the path to use frames without a commit";
}

// What the command line says about a sequence holds for a foreign log, too.
Result<AdapterOptions> AdapterWith(const std::string& path, const DatasetOptions& options,
                                   AdapterOptions adapter) {
  if (const auto checked = CheckOptions(options); !checked) return tl::unexpected(checked.error());
  if (options.registration == DepthRegistration::kKinect)
    return Fail(path + ": a log of other programs cannot be read as one of a Kinect");
  if (adapter.camera.size() > 1 && (options.intrinsics || Raw(options.camera_id) != 0)) {
    return Fail(path +
                ": the config has several cameras (adapter.camera), so --intrinsics and "
                "--camera-id cannot be given for one of them");
  }
  const auto set_in = [&](AdapterCameraOptions& camera) {
    if (options.registration == DepthRegistration::kRegistered)
      camera.registered = DepthIsRegistered::kYes;
    if (options.intrinsics)
      camera.intrinsics.assign(options.intrinsics->begin(), options.intrinsics->end());
    if (options.depth_unit_m > 0) camera.depth_unit_m = options.depth_unit_m;
    if (Raw(options.camera_id) != 0) camera.camera_id = Raw(options.camera_id);
  };
  set_in(adapter);
  for (AdapterCameraOptions& camera : adapter.camera) set_in(camera);
  return adapter;
}

Result<Recording> OpenForeignLog(const std::string& file, const DatasetOptions& options,
                                 const AdapterOptions& adapter) {
  const Result<AdapterOptions> changed = AdapterWith(file, options, adapter);
  if (!changed) return tl::unexpected(changed.error());
  Result<std::unique_ptr<ForeignDataset>> dataset = ForeignDataset::Open(file, *changed, options);
  if (!dataset) return tl::unexpected(dataset.error());
  return Recording{std::move(*dataset), {}};
}

// Whether a log without frames of ours can be one of other programs.
bool IsForeign(const std::string& file, const RecordedRun& run, const AdapterOptions& adapter) {
  if (!run.frames.empty() || !run.unusable_frames.empty()) return false;
  return HasForeignImages(file, adapter).value_or(false);
}

Result<Recording> OpenLog(const std::string& path, const DatasetOptions& options,
                          const AdapterOptions& adapter, const std::string& channel_prefix) {
  const Result<LogPath> parsed = ParseLogPath(path);
  if (!parsed) return tl::unexpected(parsed.error());
  if (parsed->foreign) return OpenForeignLog(parsed->file, options, adapter);
  Result<LogReader> reader = LogReader::Open(parsed->file, channel_prefix);
  if (!reader) return tl::unexpected(reader.error());
  const Result<RecordedRun> run = ReadRun(*reader);
  if (!run) return tl::unexpected(run.error());
  if (IsForeign(parsed->file, *run, adapter)) return OpenForeignLog(parsed->file, options, adapter);
  if (const auto checked = CheckLogOptions(path, options); !checked)
    return tl::unexpected(checked.error());
  FrameSelection selection = SelectFrames(*run, parsed->all, options);
  if (selection.frames.empty()) return Fail(parsed->file + ": " + WhyNoFrames(*run, selection));
  const auto usable = CheckIntrinsics(options, selection.frames);
  if (!usable) return Fail(parsed->file + ": " + usable.error().message);
  Recording recording;
  recording.remarks = selection.remarks;
  if (run->damaged > 0) {
    recording.remarks.push_back(parsed->file + " has " + FormatCount(run->damaged, "damaged part") +
                                "; for details run: vismap-log verify " + parsed->file);
  }
  recording.dataset = std::make_unique<LogDataset>(
      std::move(*reader), std::move(selection),
      run->detections.empty() ? std::nullopt : std::optional(path), options);
  return recording;
}

}  // namespace

bool IsLog(const std::string& path) {
  if (IsSyntheticPath(path)) return false;
  const std::string file = path.substr(0, path.find('?'));
  return HasLogName(file) || BeginsAsLog(file);
}

Result<Recording> OpenRecording(const std::string& path, const std::string& format,
                                const DatasetOptions& options, const AdapterOptions& adapter,
                                const std::string& channel_prefix) {
  if (format == "lcmlog" || (format.empty() && IsLog(path)))
    return OpenLog(path, options, adapter, channel_prefix);
  Result<std::unique_ptr<Dataset>> dataset = OpenSequence(path, format, options);
  if (!dataset) return tl::unexpected(dataset.error());
  return Recording{std::move(*dataset), {}};
}

Result<std::unique_ptr<DetectionSource>> OpenRecordedDetections(const std::string& path,
                                                                const std::string& channel_prefix) {
  if (!IsLog(path)) return OpenDetections(path);
  const Result<LogPath> parsed = ParseLogPath(path);
  if (!parsed) return tl::unexpected(parsed.error());
  Result<LogReader> reader = LogReader::Open(parsed->file, channel_prefix);
  if (!reader) return tl::unexpected(reader.error());
  const Result<RecordedRun> run = ReadRun(*reader);
  if (!run) return tl::unexpected(run.error());
  return std::make_unique<LogDetections>(std::move(*reader), *run, parsed->all);
}

}  // namespace vismap
