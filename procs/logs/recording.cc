#include "logs/recording.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "base/format.h"
#include "base/reason_counts.h"
#include "logs/log_dataset.h"
#include "simulation/sequence.h"
#include "simulation/synthetic_dataset.h"

namespace vismap {
namespace {

struct LogPath {
  std::string file;
  bool all = false;  ///< ?frames=all
};

Result<LogPath> ParseLogPath(const std::string& path) {
  const size_t question = path.find('?');
  if (question == std::string::npos) return LogPath{path, false};
  const std::string parameter = path.substr(question + 1);
  if (parameter != "frames=all" && parameter != "frames=committed") {
    return Fail(path + ": unknown parameter \"" + parameter +
                "\"; expected frames=all or frames=committed");
  }
  return LogPath{path.substr(0, question), parameter == "frames=all"};
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
  if (Raw(options.camera_id) == 0) return {};
  return Fail(path +
              ": the frames of a log keep their camera ids, so no other camera id can be given");
}

std::string WhyNoFrames(const RecordedRun& run, const FrameSelection& selection) {
  if (run.frames.empty() && run.unusable_frames.empty()) return "the log has no RGBD_FRAME";
  ReasonCounts reasons;
  for (const SkippedFrame& skipped : selection.skipped) reasons.Add(skipped.reason);
  const std::string text = NoUsableFramesText(reasons, reasons.total());
  if (run.frames.empty()) return text;
  return text + "; add ?frames=all to the path to use frames without a commit";
}

Result<Recording> OpenLog(const std::string& path, const DatasetOptions& options) {
  if (const auto checked = CheckLogOptions(path, options); !checked)
    return tl::unexpected(checked.error());
  const Result<LogPath> parsed = ParseLogPath(path);
  if (!parsed) return tl::unexpected(parsed.error());
  Result<LogReader> reader = LogReader::Open(parsed->file);
  if (!reader) return tl::unexpected(reader.error());
  const Result<RecordedRun> run = ReadRun(*reader);
  if (!run) return tl::unexpected(run.error());
  FrameSelection selection = SelectFrames(*run, parsed->all, options);
  if (selection.frames.empty()) return Fail(parsed->file + ": " + WhyNoFrames(*run, selection));
  Recording recording;
  recording.remarks = selection.remarks;
  if (run->damaged > 0) {
    recording.remarks.push_back(parsed->file + " has " + FormatCount(run->damaged, "damaged part") +
                                "; for details run: vismap-log verify " + parsed->file);
  }
  recording.dataset =
      std::make_unique<LogDataset>(std::move(*reader), std::move(selection),
                                   run->detections.empty() ? std::nullopt : std::optional(path));
  return recording;
}

}  // namespace

bool IsLog(const std::string& path) {
  if (IsSyntheticPath(path)) return false;
  const std::string file = path.substr(0, path.find('?'));
  return HasLogName(file) || BeginsAsLog(file);
}

Result<Recording> OpenRecording(const std::string& path, const std::string& format,
                                const DatasetOptions& options) {
  if (format == "lcmlog" || (format.empty() && IsLog(path))) return OpenLog(path, options);
  Result<std::unique_ptr<Dataset>> dataset = OpenSequence(path, format, options);
  if (!dataset) return tl::unexpected(dataset.error());
  return Recording{std::move(*dataset), {}};
}

Result<std::unique_ptr<DetectionSource>> OpenRecordedDetections(const std::string& path) {
  if (!IsLog(path)) return OpenDetections(path);
  const Result<LogPath> parsed = ParseLogPath(path);
  if (!parsed) return tl::unexpected(parsed.error());
  Result<LogReader> reader = LogReader::Open(parsed->file);
  if (!reader) return tl::unexpected(reader.error());
  const Result<RecordedRun> run = ReadRun(*reader);
  if (!run) return tl::unexpected(run.error());
  return std::make_unique<LogDetections>(std::move(*reader), *run, parsed->all);
}

}  // namespace vismap
