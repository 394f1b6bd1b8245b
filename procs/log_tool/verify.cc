#include "log_tool/verify.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "base/format.h"
#include "logs/log_dataset.h"
#include "logs/recorded_run.h"
#include "wire/channel_types.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

constexpr uint64_t kLargestStep = 1'000'000'000;
// Latest sequence number of each channel and source.
using Sequences = std::map<std::pair<std::string, std::string>, int64_t>;

void TrackSequence(const LogEvent& event, const MessageHead& head, Sequences* sequences,
                   ChannelReport* report) {
  const auto [entry, first] = sequences->try_emplace({event.channel, head.source}, head.seq);
  const int64_t last = std::exchange(entry->second, head.seq);
  if (first) return;  // nothing to compare with
  // Unsigned, so that it cannot overflow. A larger step is not a loss: no process sends that many
  // messages.
  const uint64_t step = static_cast<uint64_t>(head.seq) - static_cast<uint64_t>(last);
  if (head.seq > last && step <= kLargestStep) {
    report->lost += static_cast<int64_t>(step) - 1;
  } else {
    ++report->repeated;
  }
}

void RecordProblem(const LogEvent& event, const std::string& what, ChannelReport* report) {
  if (report->first_problem.empty())
    report->first_problem = "at byte " + std::to_string(event.offset) + ": " + what;
}

void AddMessage(const LogEvent& event, const std::string& own_channel,
                std::span<const uint8_t> bytes, Sequences* sequences, ChannelReport* report) {
  if (report->messages++ == 0) report->first_time = event.timestamp;
  report->last_time = event.timestamp;
  report->bytes += event.data_size;
  const ChannelType* type = FindChannelType(own_channel);
  if (type == nullptr) return;  // a channel of another program
  const std::optional<MessageHead> head = PeekHead(bytes);
  const Result<void> checked = type->check(bytes, type->channel);
  if (head && head->fingerprint == type->fingerprint)
    TrackSequence(event, *head, sequences, report);
  if (checked) return;
  const bool other_type = head && head->fingerprint != type->fingerprint;
  ++(other_type ? report->other_type : report->undecodable);
  RecordProblem(event, checked.error().message, report);
}

// Counts the integrated and skipped frames.
Result<void> FollowFrames(LogReader& reader, LogReport* report) {
  Result<LogReader> again = LogReader::Open(reader.path(), reader.channel_prefix());
  if (!again) return tl::unexpected(again.error());
  const Result<RecordedRun> run = ReadRun(*again);
  if (!run) return tl::unexpected(run.error());
  report->frames_sent = static_cast<int64_t>(run->frames.size());
  std::set<FrameKey> integrated, skipped;
  for (const frame_commit_t& commit : run->commits) {
    if (commit.status == frame_commit_t::STATUS_INTEGRATED) integrated.insert(KeyOf(commit));
    if (commit.status == frame_commit_t::STATUS_SKIPPED) skipped.insert(KeyOf(commit));
  }
  report->frames_integrated = static_cast<int64_t>(integrated.size());
  report->frames_skipped = static_cast<int64_t>(skipped.size());
  report->recording =
      CheckRecording(LogDataset(std::move(*again), SelectFrames(*run, true, {}), {}, {}),
                     DepthLimits{}, SurfaceOptions{}, CheckedFrames::kAll);
  if (run->commits.empty()) return {};  // the map server was not recorded
  for (const auto& entry : run->index) {
    if (!integrated.contains(entry.first) && !skipped.contains(entry.first))
      ++report->frames_without_commit;
  }
  report->run_problems = SelectFrames(*run, false, {}).remarks;
  return {};
}

}  // namespace

double ChannelReport::rate() const {
  const double seconds = (static_cast<double>(last_time) - static_cast<double>(first_time)) * 1e-6;
  return seconds > 0 ? static_cast<double>(messages - 1) / seconds : 0;
}

Result<LogReport> VerifyLog(LogReader& reader) {
  LogReport report;
  report.bytes = reader.size();
  report.channel_prefix = reader.channel_prefix();
  Sequences sequences;
  const auto on_event = [&](const LogEvent& event) -> Result<void> {
    const Result<std::vector<uint8_t>> bytes = reader.ReadData(event);
    if (!bytes) return tl::unexpected(bytes.error());
    ++report.events;
    AddMessage(event, reader.OwnChannel(event), *bytes, &sequences,
               &report.channels[event.channel]);
    return {};
  };
  const Result<void> read = ForEachEvent(
      reader, on_event, [&](const LogDamage& damage) { report.damage.push_back(damage); });
  if (!read) return tl::unexpected(read.error());
  if (report.events == 0) return Fail(reader.path() + ": the file has no LCM event");
  if (const Result<void> followed = FollowFrames(reader, &report); !followed)
    return tl::unexpected(followed.error());
  return report;
}

std::vector<std::string> LogReport::Problems() const {
  std::vector<std::string> problems;
  for (const LogDamage& bad : damage) {
    problems.push_back(FormatBytes(bad.bytes) + " at byte " + std::to_string(bad.offset) +
                       (bad.truncated ? " are the beginning of an event: the log is truncated"
                                      : " are damaged: they are not a complete event"));
  }
  for (const auto& [name, channel] : channels) {
    const auto add = [&, &of = name](int64_t count, const std::string& one,
                                     const std::string& several, const std::string& detail) {
      if (count > 0) problems.push_back(of + ": " + FormatCount(count, one, several) + detail);
    };
    const std::string first = "; the first problem is " + channel.first_problem;
    add(channel.lost, "lost message", "", "");
    add(channel.other_type, "message of a wrong type", "messages of a wrong type", first);
    add(channel.undecodable, "damaged message", "", first);
  }
  // Damaged messages were told above.
  const auto frames = channels.find(channel_prefix + kRgbdFrameChannel.name);
  const int64_t told =
      frames == channels.end() ? 0 : frames->second.undecodable + frames->second.other_type;
  if (const int64_t left_out = recording.left_out.total(); left_out > told) {
    problems.push_back(std::to_string(left_out) +
                       " RGBD_FRAMEs cannot be used: " + recording.left_out.Text());
  }
  if (const int64_t without = recording.without_color.total(); without > 0) {
    problems.push_back("the colour of " + FormatCount(without, "RGBD_FRAME") +
                       " cannot be decoded: " + recording.without_color.Text());
  }
  problems.insert(problems.end(), recording.findings.begin(), recording.findings.end());
  problems.insert(problems.end(), run_problems.begin(), run_problems.end());
  return problems;
}

}  // namespace vismap
