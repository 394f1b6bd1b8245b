#pragma once

#include <string>

namespace vismap {

/// Reports the state of this process to the service manager that started it (systemd with
/// Type=notify, or scripts/launch). Does nothing when $NOTIFY_SOCKET is not set. For use by one
/// thread.
class ServiceManager {
 public:
  ServiceManager();

  /// Reports that the process is ready, so that units ordered after this one start. Only the first
  /// call sends a message.
  void SetReady();
  /// Sets the sentence that `systemctl status` shows.
  void SetStatus(const std::string& sentence);
  /// Tells the watchdog that the main loop still runs. Call it at least every alive_period(); it
  /// sends at most one message in that time. The service manager restarts the process after two
  /// periods without a message.
  void KeepAlive();
  /// Reports that the process is stopping. From then on the time limit for stopping applies instead
  /// of the watchdog.
  void SetStopping();

  /// Half of the watchdog's time limit [s]; 0 = there is no watchdog.
  double alive_period() const { return alive_period_; }

 private:
  double alive_period_ = 0;
  double next_alive_ = 0;
  bool ready_ = false;
};

}  // namespace vismap
