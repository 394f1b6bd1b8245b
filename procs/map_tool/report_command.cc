#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/file.h"
#include "base/json_text.h"
#include "base/probe_folder.h"
#include "logs/recording.h"
#include "map_tool/child_program.h"
#include "map_tool/commands.h"
#include "map_tool/live_map.h"
#include "map_tool/log_summary.h"
#include "pictures/report.h"
#include "runtime/progress.h"
#include "runtime/version.h"

// The subcommand `report` of vismap-map.

namespace vismap {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kProbedBytes = 1;
constexpr int64_t kParts = 15;  // of a report, for its progress

/// A folder that goes away with this value.
class TemporaryFolder {
 public:
  TemporaryFolder() = default;
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  Result<fs::path> Make() {
    std::error_code error;
    const fs::path parent = fs::temp_directory_path(error);
    std::string pattern = (error ? fs::path("/tmp") : parent) / "vismap-report-XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr)
      return Fail("cannot create the folder " + pattern + " for intermediate results");
    path_ = pattern;
    return path_;
  }

 private:
  fs::path path_;
};

std::string TextOf(const fs::path& path) {
  const auto bytes = ReadFileBytes(path, uint64_t{64} << 20);
  return bytes ? std::string(bytes->begin(), bytes->end()) : "";
}

/// Reads the script of the page, see scripts/page.
void FindScript(const std::string& page_folder, ReportInput* input) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  std::vector<fs::path> folders{page_folder};
  if (page_folder.empty()) folders = {program / "../../page", program / "../share/vismap/page"};
  for (const fs::path& folder : folders) {
    input->script = TextOf(folder / "report.js");
    // Such a script would end within the page.
    if (!input->script.empty() && input->script.find("</script") == std::string::npos) return;
  }
  input->script.clear();
  input->no_script =
      "Here is a map to look at, but not to turn: the script for that was not built when this "
      "report was made. scripts/page builds it.";
}

/// What is reported on.
struct Subject {
  fs::path map;          ///< the saved map
  std::string sequence;  ///< what has to be mapped first; "" = nothing
  fs::path run;          ///< report.json of the run; it may be missing
};

Subject SubjectOf(const std::string& path) {
  std::error_code ignored;
  if (fs::is_regular_file(fs::path(path) / "map.vismap", ignored))
    return {fs::path(path) / "map.vismap", "", fs::path(path) / "report.json"};
  if (fs::path(path).extension() == ".vismap")
    return {path, "", fs::path(path).parent_path() / "report.json"};
  return {"", path, ""};
}

/// The options of this program that the programs it starts need, too.
std::vector<std::string> CommonArguments(const ProcessContext& context) {
  std::vector<std::string> arguments;
  if (!context.options.config_path.empty()) arguments = {"--config", context.options.config_path};
  return arguments;
}

// Called before another program is started, whose message would be about that program.
Outcome CheckExists(const std::string& sequence) {
  std::error_code ignored;
  const std::string path = sequence.substr(0, sequence.find('?'));
  if (path.starts_with("synthetic:") || fs::exists(path, ignored)) return {};
  return ExitWith(ExitCode::kUnreadable,
                  sequence +
                      ": no such file or folder; expected a saved map (.vismap), a folder "
                      "with map.vismap in it, a log, a recorded sequence, or 'live'");
}

Outcome MapSequenceFirst(const ProcessContext& context, const fs::path& folder, Subject* subject) {
  std::vector<std::string> arguments{"--dataset", subject->sequence, "--out", folder / "run"};
  const std::vector<std::string> common = CommonArguments(context);
  arguments.insert(arguments.end(), common.begin(), common.end());
  if (!context.options.channel_prefix.empty())
    arguments.insert(arguments.end(), {"--channel-prefix", context.options.channel_prefix});
  const Result<void> mapped = RunSibling("offline-mapper", arguments, context.stop);
  if (!mapped)
    return ExitWith(ExitCode::kUnreadable, subject->sequence + ": " + mapped.error().message);
  subject->map = folder / "run/map.vismap";
  subject->run = folder / "run/report.json";
  return {};
}

/// Takes the report.json beside the map, if it is of this map, or says why not.
void AddRun(const Subject& subject, const std::string& map_hash, ReportInput* input) {
  const std::string text = subject.run.empty() ? "" : TextOf(subject.run);
  if (text.empty()) {
    input->no_run =
        "They stand in the report.json that vismap-offline-mapper writes beside a map; there is "
        "none that can be read.";
    return;
  }
  const auto json = ParseJson(text);
  if (!json || !json->is_object()) {
    input->no_run = "The report.json beside the map is no JSON object.";
  } else {
    const nlohmann::json map = json->value("map", nlohmann::json::object());
    if (map.is_object() && map.value("hash", nlohmann::json()) == map_hash) {
      input->run_json = text;
      return;
    }
    input->no_run = "The report.json beside the map is of another map.";
  }
  LogWarning(subject.run.string() + ": the report leaves it out. " + input->no_run);
}

Outcome AddScores(const MapToolArguments& arguments, const ProcessContext& context,
                  const fs::path& map, const fs::path& folder, ReportInput* input) {
  if (arguments.truth.empty()) {
    input->no_scores = "No ground truth was named; --truth names one.";
    return {};
  }
  const fs::path file = folder / "scores.json";
  std::vector<std::string> options{"--gt", arguments.truth, "--map", map, "--out", file};
  const std::vector<std::string> common = CommonArguments(context);
  options.insert(options.end(), common.begin(), common.end());
  const Result<void> scored = RunSibling("evaluate", options, context.stop);
  if (!scored)
    return ExitWith(ExitCode::kUnreadable,
                    "--truth " + arguments.truth + ": " + scored.error().message);
  input->scores_json = TextOf(file);
  return {};
}

Outcome AddProcesses(const MapToolArguments& arguments, const ProcessContext& context,
                     ReportInput* input) {
  if (!IsLog(arguments.map)) {
    input->no_processes =
        "The report is not of a log, so nothing is known of processes and channels.";
    return {};
  }
  auto summary = SummarizeLog(arguments.map.substr(0, arguments.map.find('?')),
                              context.options.channel_prefix);
  if (!summary) return ExitWith(ExitCode::kUnreadable, summary.error().message);
  input->processes = std::move(summary->processes);
  input->channels = std::move(summary->channels);
  if (summary->unreadable > 0)
    LogWarning(arguments.map + ": " + std::to_string(summary->unreadable) +
               " STATUS messages cannot be read");
  if (summary->left_out > 0)
    LogWarning(arguments.map + ": " + std::to_string(summary->left_out) +
               " messages of further channels or sources are not in the report, which lists 256 "
               "of each");
  return {};
}

// Found out before the work.
Outcome CheckOut(const MapToolArguments& arguments) {
  const fs::path out = arguments.out;
  const std::string input = arguments.map.substr(0, arguments.map.find('?'));
  if (const Result<void> other = CheckIsNotInput(input, out); !other)
    return ExitWith(ExitCode::kUsage, other.error().message);
  const Result<void> probed = ProbeFolder(fs::absolute(out).parent_path(), kProbedBytes);
  if (!probed) return ExitWith(ExitCode::kFailed, probed.error().message);
  return {};
}

Outcome WriteReport(const MapToolArguments& arguments, const LoadedMap& loaded,
                    const ReportInput& input, const StopSignal& stop) {
  std::string html;
  {
    Progress progress("report of " + input.source, kParts);
    int64_t done = 0;
    html = ReportHtml(loaded, arguments.config, input, [&](const std::string& part) {
      progress.Show(done++, part);
      return !stop.requested();
    });
  }
  if (html.empty())
    return ExitWith(ExitCode::kFailed, "stopped before the report was complete; it is not written");
  if (const auto written = WriteFileAtomically(arguments.out, html); !written)
    return ExitWith(ExitCode::kFailed, written.error().message);
  std::printf("wrote the report %s\n", fs::absolute(arguments.out).c_str());
  return {};
}

}  // namespace

Outcome RunReport(const MapToolArguments& arguments, ProcessContext& context) {
  if (const Outcome writable = CheckOut(arguments); !writable) return writable;
  Subject subject = arguments.map == kLive ? Subject{kLive, "", ""} : SubjectOf(arguments.map);
  if (!subject.sequence.empty()) {
    if (const Outcome exists = CheckExists(subject.sequence); !exists) return exists;
  }
  TemporaryFolder temporary;
  const Result<fs::path> folder = temporary.Make();
  if (!folder) return ExitWith(ExitCode::kFailed, folder.error().message);
  ReportInput input;
  input.source = arguments.map == kLive ? "the running map server" : arguments.map;
  input.version = std::string("vismap-map ") + Version();
  FindScript(arguments.config.viewer.page_folder, &input);
  if (const Outcome added = AddProcesses(arguments, context, &input); !added) return added;

  if (!subject.sequence.empty()) {
    if (const Outcome mapped = MapSequenceFirst(context, *folder, &subject); !mapped) return mapped;
  }
  MapToolArguments of_map = arguments;
  of_map.map = subject.map;
  const auto loaded = LoadMapOrLive(of_map, context);
  if (!loaded) return tl::unexpected(loaded.error());
  AddRun(subject, loaded->map_hash, &input);
  if (arguments.map == kLive && !arguments.truth.empty()) {
    subject.map = *folder / "live.vismap";
    if (const auto saved = SaveMap(loaded->map, loaded->metadata, subject.map); !saved)
      return ExitWith(ExitCode::kFailed, saved.error().message);
  }
  if (const Outcome scored = AddScores(arguments, context, subject.map, *folder, &input); !scored)
    return scored;
  return WriteReport(arguments, *loaded, input, context.stop);
}

}  // namespace vismap
