#include "runtime/service_manager.h"

#include <systemd/sd-daemon.h>

#include <algorithm>

#include "runtime/clock.h"

namespace vismap {
namespace {

// Errors are ignored: the time limits of the service manager detect a process that does not report.
void Send(const std::string& message) { sd_notify(0, message.c_str()); }

}  // namespace

ServiceManager::ServiceManager() {
  uint64_t watchdog_us = 0;
  if (sd_watchdog_enabled(0, &watchdog_us) > 0) {
    alive_period_ = static_cast<double>(watchdog_us) * 1e-6 / 2;
  }
}

void ServiceManager::SetReady() {
  if (ready_) return;
  ready_ = true;
  Send("READY=1");
}

void ServiceManager::SetStatus(const std::string& sentence) {
  // A line break would start another assignment, and the sentence may contain text from the bus.
  std::string line = sentence;
  std::replace(line.begin(), line.end(), '\n', ' ');
  Send("STATUS=" + line);
}

void ServiceManager::KeepAlive() {
  const double now = MonotonicSeconds();
  if (alive_period_ <= 0 || now < next_alive_) return;
  next_alive_ = now + alive_period_;
  Send("WATCHDOG=1");
}

void ServiceManager::SetStopping() { Send("STOPPING=1"); }

}  // namespace vismap
