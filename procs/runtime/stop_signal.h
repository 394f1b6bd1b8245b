#pragma once

#include <atomic>

namespace vismap {

/// The wish that the process ends: a flag and a file descriptor that becomes readable with it, so
/// that loops which wait in poll() wake up.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// From any thread or signal handler; may be called again.
  void Request();
  bool requested() const { return requested_.load(); }
  int fd() const { return pipe_[0]; }

  /// Waits up to `seconds` or until requested; returns requested().
  bool WaitFor(double seconds) const;

  /// SIGINT and SIGTERM request `stop`, a second one of them ends the process at once; SIGPIPE is
  /// ignored. Once per process; `stop` must outlive it.
  static void InstallHandlers(StopSignal* stop);

 private:
  std::atomic<bool> requested_{false};
  int pipe_[2] = {-1, -1};
};

}  // namespace vismap
