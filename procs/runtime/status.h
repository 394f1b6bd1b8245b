#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "runtime/bus.h"
#include "runtime/service_manager.h"

namespace vismap {

/// How a process fares, as people and other processes see it.
enum class ProcessState {
  kStarting,  ///< not yet able to take work
  kReady,     ///< subscribed and able, nothing has come yet
  kWaiting,   ///< has work that lacks an input; the message says which
  kRunning,   ///< at work
  kStopping,
};
const char* StateName(ProcessState state);

/// Publishes STATUS once a second and at every change of state: state, what it waits for, counters,
/// timings. The figures of the bus (CHANNEL.received, .rejected, .lost, .unsent ...) are added by
/// themselves.
class Status {
 public:
  /// `process` = which program, for example "depth-segmenter". Starts in kStarting. `service`, when
  /// there is one, hears the same. Both must outlive it.
  Status(Bus* bus, std::string process, ServiceManager* service = nullptr);

  /// `message` = one sentence, for example "waiting for DETECTIONS: none in 5 s"; empty = all is
  /// well.
  void Set(ProcessState state, const std::string& message = "");
  ProcessState state() const { return state_; }

  void Count(const std::string& counter, int64_t amount = 1) { counters_[counter] += amount; }
  void SetCounter(const std::string& counter, int64_t value) { counters_[counter] = value; }
  int64_t counter(const std::string& name) const;
  /// Adds a duration [ms] to those of which the next status gives median and maximum.
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
};

/// Adds the time from its making to its end to `status`: `StageTimer timer(status,
/// "segmentation");`
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
