#pragma once

#include <string>

namespace vismap {

/// Tells the service manager that started this process (systemd, Type=notify) how it fares. Without
/// one, that is without $NOTIFY_SOCKET, nothing happens. Not for several threads.
class ServiceManager {
 public:
  ServiceManager();

  /// Able to take work: units that are ordered after this one start. Sent once.
  void SetReady();
  /// One sentence for `systemctl status`.
  void SetStatus(const std::string& sentence);
  /// The loop of the process goes round; to be called at least every alive_period(). Sends no more
  /// than one message in that time. When none comes for two periods, the manager restarts the
  /// process.
  void KeepAlive();
  /// Ending on request: no longer watched by the watchdog's time, but by that for stopping.
  void SetStopping();

  /// Half the watchdog's time [s]; 0 = there is no watchdog.
  double alive_period() const { return alive_period_; }

 private:
  double alive_period_ = 0;
  double next_alive_ = 0;
  bool ready_ = false;
};

}  // namespace vismap
