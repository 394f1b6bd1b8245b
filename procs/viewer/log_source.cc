#include "viewer/log_source.h"

#include <exception>
#include <filesystem>
#include <set>
#include <utility>
#include <variant>

#include "base/printable.h"
#include "base/reason_counts.h"
#include "logs/log_reader.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/progress.h"
#include "runtime/version.h"
#include "sequence_mapper/map_sequence.h"
#include "settings/settings.h"
#include "viewer/log_recorder.h"

namespace vismap {
namespace {

constexpr size_t kMostNamed = 20;     // channels in a sentence
constexpr double kStatePeriod = 0.5;  // [s]

// "; its channels are A, B and 3 others", or "" when it is no log.
std::string ChannelsOf(const std::string& path) {
  if (!IsLog(path)) return "";
  Result<LogReader> reader = LogReader::Open(path.substr(0, path.find('?')));
  if (!reader) return "";
  std::set<std::string> channels;
  const auto read = ForEachEvent(
      *reader,
      [&](const LogEvent& event) -> Result<void> {
        channels.insert(event.channel);
        return {};
      },
      [](const LogDamage&) {});
  if (!read || channels.empty()) return "";
  std::string text;
  size_t named = 0;
  for (const std::string& channel : channels) {
    if (named++ < kMostNamed) text += (text.empty() ? "" : ", ") + PrintableText(channel, 64);
  }
  if (named > kMostNamed) text += " and " + std::to_string(named - kMostNamed) + " others";
  return "; its channels are " + text;
}

void Append(const std::string& sentence, std::string* text) {
  *text += (text->empty() ? "" : "; ") + sentence;
}

}  // namespace

Result<std::unique_ptr<LogSource>> LogSource::Open(const std::string& path,
                                                   const VismapConfig& config) {
  Result<Recording> log =
      OpenRecording(path, "", {}, config.adapter, config.pipeline.channel_prefix);
  if (!log) return Fail(log.error().message + ChannelsOf(path));
  Result<SequenceDetector> detector = OpenSequenceDetector("", false, config, *log->dataset);
  if (!detector) return tl::unexpected(detector.error());
  const uint64_t max_bytes = static_cast<uint64_t>(config.viewer.log_mb) << 20;
  // Another run of the viewer has another map, so that pages that stay open begin anew.
  const std::string map_id = log->dataset->name() + "-" + std::to_string(WallUtime());
  auto recorded = LogRecording::Open(config.viewer.log_folder, max_bytes, map_id);
  if (!recorded)
    return Fail(recorded.error().message + "; viewer.log_folder chooses another folder");
  return std::unique_ptr<LogSource>(
      new LogSource(config, std::move(*log), std::move(*detector), std::move(*recorded)));
}

LogSource::LogSource(const VismapConfig& config, Recording log, SequenceDetector detector,
                     std::unique_ptr<LogRecording> recorded)
    : config_(config),
      log_(std::move(log)),
      detector_(std::move(detector)),
      recorded_(std::move(recorded)),
      frames_(static_cast<size_t>(config.viewer.evidence_mb) * kMegabyte),
      name_(log_.dataset->name()) {
  state_.total = static_cast<int64_t>(log_.dataset->size());
  for (const std::string& remark : log_.remarks) {
    LogWarning(remark);
    Append(remark, &state_.message);
  }
  recorded_->SetState(state_);
}

LogSource::~LogSource() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void LogSource::Start() {
  thread_ = std::thread([this] { Map(); });
}

void LogSource::Map() {
  try {
    MapAll();
  } catch (const std::exception& error) {
    Append(std::string("mapping ended by an internal error (please report it): ") + error.what(),
           &state_.message);
    LogError(state_.message);
  }
  state_.done = true;
  recorded_->SetState(state_);
}

MapMetadata LogSource::NewMetadata() const {
  MapMetadata metadata;
  metadata.map_id = recorded_->map_id();
  metadata.config = PrintConfig(config_);
  metadata.created_by = std::string("vismap-viewer ") + Version();
  return metadata;
}

Result<std::shared_ptr<const LoadedMap>> LogSource::MapAfter(int64_t frames,
                                                             const std::atomic<bool>* stop) const {
  const std::shared_ptr<const LoadedMap> copy = recorded_->CopyAt(frames);
  const bool begins = copy == nullptr || copy->map.revision > frames;
  Result<MapSession> session =
      begins ? MapSession(config_, NewMetadata()) : MapSession::Continue(config_, LoadedMap(*copy));
  if (!session) return tl::unexpected(session.error());
  OfflineInput input{*log_.dataset, detector_.recorded.get(), detector_.network.get()};
  // What was left out before the copy is left out again, also if the map would take it now.
  if (!begins) input.first = read_after_.at(static_cast<size_t>(copy->map.revision - 1));
  input.is_part = true;
  StageTimes times;
  const auto proceed = [&](size_t) { return !*stop && session->map().revision < frames; };
  const auto mapped = MapSequence(input, config_, proceed, &*session, &times);
  if (!mapped) return tl::unexpected(mapped.error());
  if (session->map().revision != frames)
    return Fail("the map after " + std::to_string(frames) + " frames of " + name_ +
                " could not be made: it has " + std::to_string(session->map().revision) +
                " frames only");
  return std::make_shared<const LoadedMap>(LoadedMap{session->map(), session->metadata(), ""});
}

void LogSource::MapAll() {
  MapSession session(config_, NewMetadata());
  LogRecorder recorder(config_, &session, recorded_.get(), &frames_);
  StageTimes times;
  Progress progress("mapping " + name_, state_.total);
  double told = 0;
  const auto proceed = [&](size_t done) {
    progress.Show(static_cast<int64_t>(done));
    state_.read = static_cast<int64_t>(done);
    state_.mapped = session.map().revision;
    if (MonotonicSeconds() - told > kStatePeriod) {
      told = MonotonicSeconds();
      recorded_->SetState(state_);
    }
    return !stop_ && recorder.failure().empty();
  };
  OfflineInput input{*log_.dataset, detector_.recorded.get(), detector_.network.get()};
  input.on_segmented = [&](const SegmentedFrame& frame) { recorder.OnSegmented(frame); };
  input.on_mapped = [&](const MapDelta& delta) {
    read_after_.push_back(static_cast<size_t>(state_.read) + 1);
    recorder.OnMapped(delta);
  };
  const Result<MappedSequence> mapped = MapSequence(input, config_, proceed, &session, &times);
  if (stop_) return;
  recorder.Finish();
  state_.mapped = session.map().revision;
  if (recorder.failure().empty()) state_.read = state_.total;
  for (const std::string& problem :
       {mapped ? std::string() : mapped.error().message, recorder.failure(),
        mapped && mapped->left_out.total() > 0
            ? LeftOutText(mapped->left_out, mapped->frames + mapped->left_out.total())
            : std::string()}) {
    if (problem.empty()) continue;
    LogWarning(problem);
    Append(problem, &state_.message);
  }
  LogInfo(name_ + " is recorded: " + std::to_string(recorded_->moments().size()) + " moments, " +
          std::to_string(recorded_->disk_bytes() >> 20) + " MB on disk, " +
          std::to_string(recorded_->index_bytes() >> 20) + " MB of index");
}

}  // namespace vismap
