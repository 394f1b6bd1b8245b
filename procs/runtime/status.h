#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/stopwatch.h"
#include "runtime/bus.h"
#include "runtime/recent_timings.h"
#include "runtime/service_manager.h"

namespace vismap {

/// Names of the counters that are percentiles of the durations of a stage [us].
inline constexpr std::string_view kP50Counter = "p50_us.", kP95Counter = "p95_us.";
inline bool IsPercentile(std::string_view counter) {
  return counter.starts_with(kP50Counter) || counter.starts_with(kP95Counter);
}

/// The state of a process, as published on STATUS.
enum class ProcessState {
  kStarting,  ///< cannot accept work yet
  kReady,     ///< can accept work, but has received none yet
  kWaiting,   ///< has work, but an input is missing; the message says which
  kRunning,   ///< working
  kStopping,
};
const char* StateName(ProcessState state);

/// Publishes STATUS once a second and at every change of state: state, message, counters, timings
/// and findings. It adds the counters of the bus (CHANNEL.received, .rejected, .lost, .unsent ...)
/// itself.
class Status {
 public:
  /// `process` is the name of the program, for example "depth-segmenter". The first state is
  /// kStarting. `service` may be nullptr; else it gets the same state and message. `bus` and
  /// `service` must outlive the object.
  Status(Bus* bus, std::string process, ServiceManager* service = nullptr);

  /// `message` is one sentence, for example "waiting for DETECTIONS: none in 5 s"; "" = no problem.
  void Set(ProcessState state, const std::string& message = "");
  ProcessState state() const { return state_; }

  void Count(const std::string& counter, int64_t amount = 1) { counters_[counter] += amount; }
  void SetCounter(const std::string& counter, int64_t value) { counters_[counter] = value; }
  int64_t counter(const std::string& name) const;
  /// Replaces what is wrong or suspect about one subject, such as "poses", one sentence each; empty
  /// = nothing. The next STATUS has it, and vismap-doctor repeats it and does not call such a
  /// system healthy. It is logged when a subject gets more sentences than before. A STATUS has at
  /// most 16 sentences and says how many more there are; there are at most 64 subjects, and further
  /// ones count as one.
  void SetFindings(const std::string& subject, std::vector<std::string> sentences);
  void SetFinding(const std::string& subject, const std::optional<std::string>& sentence);
  /// All sentences, by subject.
  std::vector<std::string> findings() const;
  /// Adds a duration [ms]. The next STATUS has median and maximum of the durations of a stage, and
  /// counters kP50Counter + STAGE and kP95Counter + STAGE of the last minute.
  void AddTiming(const std::string& stage, double ms);

  void Publish();

 private:
  void UpdateServiceManager();

  Bus* bus_;
  ServiceManager* service_;
  std::string process_;
  int64_t start_utime_;
  ProcessState state_ = ProcessState::kStarting;
  std::string message_;
  std::map<std::string, int64_t> counters_;
  std::map<std::string, std::vector<double>> timings_ms_;
  std::map<std::string, RecentTimings> recent_;               // by stage
  std::map<std::string, std::vector<std::string>> findings_;  // by subject
};

/// A stopwatch that adds the durations of stages to `status`, which must outlive it.
Stopwatch StageTimings(Status* status);

/// Measures the time from its construction to its destruction and adds it to `status`: `const
/// StageTimer timer(status, "segmentation");`
class StageTimer {
 public:
  StageTimer(Status* status, std::string stage);
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  Status* status_;
  std::string stage_;
  double start_;
};

}  // namespace vismap
