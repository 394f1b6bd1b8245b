#include "map_tool/log_summary.h"

#include <algorithm>
#include <map>
#include <vismap/process_status_t.hpp>

#include "logs/log_reader.h"
#include "logs/recorded_run.h"
#include "runtime/status.h"
#include "wire/channels.h"

namespace vismap {
namespace {

// Messages of more sources and channels than these are only counted.
constexpr size_t kMostListed = 256;

struct ChannelTimes {
  ReportChannel channel;
  int64_t first = 0, last = 0;  // [us]

  void Add(const LogEvent& event) {
    if (channel.messages++ == 0) first = event.timestamp;
    last = event.timestamp;
    channel.bytes += event.data_size;
  }
  ReportChannel Finish() const {
    ReportChannel finished = channel;
    const double seconds = (static_cast<double>(last) - static_cast<double>(first)) * 1e-6;
    if (seconds > 0) finished.per_second = static_cast<double>(channel.messages - 1) / seconds;
    return finished;
  }
};

/// All that one source has said.
class ProcessHistory {
 public:
  void Add(const process_status_t& status) {
    if (count_++ == 0) first_ = status;
    last_ = status;
    for (size_t i = 0; i < status.timing_names.size(); ++i) {
      Timing& timing = timings_[status.timing_names[i]];
      timing.medians.push_back(status.median_ms[i]);
      timing.longest = std::max(timing.longest, status.max_ms[i]);
    }
  }

  ReportProcess Finish() {
    ReportProcess process;
    process.source = last_.source;
    process.process = last_.process;
    process.host = last_.host;
    process.version = last_.version;
    process.state = last_.state;
    process.message = last_.message;
    process.findings = last_.findings;
    process.seconds = (static_cast<double>(last_.utime) - static_cast<double>(first_.utime)) * 1e-6;
    for (size_t i = 0; i < last_.counter_names.size(); ++i)
      if (!IsPercentile(last_.counter_names[i]))
        process.counters.push_back(CounterAt(i, process.seconds));
    for (auto& [name, timing] : timings_) {
      const auto middle = timing.medians.begin() + std::ssize(timing.medians) / 2;
      std::nth_element(timing.medians.begin(), middle, timing.medians.end());
      process.timings.push_back({name, *middle, timing.longest});
    }
    return process;
  }

 private:
  struct Timing {
    std::vector<double> medians;
    double longest = 0;
  };

  ReportProcess::Counter CounterAt(size_t i, double seconds) const {
    const std::string& name = last_.counter_names[i];
    const auto& names = first_.counter_names;
    const auto found = std::find(names.begin(), names.end(), name);
    // Counters begin at 0 when the process was started again.
    const bool same_start = first_.start_utime == last_.start_utime && found != names.end();
    const double before =
        same_start
            ? static_cast<double>(first_.counter_values[static_cast<size_t>(found - names.begin())])
            : 0;
    const double growth = static_cast<double>(last_.counter_values[i]) - before;
    return {name, last_.counter_values[i], seconds > 0 ? growth / seconds : 0};
  }

  int64_t count_ = 0;
  process_status_t first_{}, last_{};
  std::map<std::string, Timing> timings_;
};

}  // namespace

Result<LogSummary> SummarizeLog(const std::string& path, const std::string& channel_prefix) {
  auto reader = LogReader::Open(path, channel_prefix);
  if (!reader) return tl::unexpected(reader.error());
  LogSummary summary;
  std::map<std::string, ChannelTimes> channels;
  std::map<std::string, ProcessHistory> processes;
  const auto on_event = [&](const LogEvent& event) -> Result<void> {
    if (channels.size() < kMostListed || channels.contains(event.channel)) {
      ChannelTimes& times = channels[event.channel];
      times.channel.name = event.channel;
      times.Add(event);
    } else {
      ++summary.left_out;
    }
    if (reader->OwnChannel(event) != kStatusChannel.name) return {};
    const auto status = ReadMessage<process_status_t>(*reader, event, kStatusChannel);
    if (!status) {
      ++summary.unreadable;
    } else if (processes.size() < kMostListed || processes.contains(status->source)) {
      processes[status->source].Add(*status);
    } else {
      ++summary.left_out;
    }
    return {};
  };
  const Result<void> read = ForEachEvent(*reader, on_event, [](const LogDamage&) {});
  if (!read) return tl::unexpected(read.error());
  for (const auto& [name, times] : channels) summary.channels.push_back(times.Finish());
  for (auto& [source, history] : processes) summary.processes.push_back(history.Finish());
  return summary;
}

}  // namespace vismap
