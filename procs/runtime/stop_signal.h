#pragma once

#include <atomic>

namespace vismap {

/// A request that the process ends: a flag, and a file descriptor that becomes readable with it, so
/// that loops that wait in poll() wake up.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// May be called from any thread or signal handler, and more than once.
  void Request();
  bool requested() const { return requested_.load(); }
  int fd() const { return pipe_[0]; }

  /// Waits until requested, at most `seconds`; returns requested().
  bool WaitFor(double seconds) const;

  /// Makes SIGINT and SIGTERM request `stop`; a second signal ends the process immediately. SIGPIPE
  /// and SIGXFSZ are ignored. Call it once per process; `stop` must outlive all signals.
  static void InstallHandlers(StopSignal* stop);

 private:
  std::atomic<bool> requested_{false};
  int pipe_[2] = {-1, -1};
};

}  // namespace vismap
