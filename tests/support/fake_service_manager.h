#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/temp_folder.h"

namespace vismap {

/// Replaces systemd in tests. During its lifetime, this process and its children find
/// $NOTIFY_SOCKET and a watchdog of `watchdog_us` microseconds in their environment; their messages
/// are kept.
class FakeServiceManager {
 public:
  explicit FakeServiceManager(int64_t watchdog_us) {
    const std::string path = (folder_ / "notify").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0)
      throw std::runtime_error("cannot bind " + path);
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
    setenv("WATCHDOG_USEC", std::to_string(watchdog_us).c_str(), 1);
  }
  ~FakeServiceManager() {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    close(socket_);
  }
  FakeServiceManager(const FakeServiceManager&) = delete;
  FakeServiceManager& operator=(const FakeServiceManager&) = delete;

  /// Receives messages, waiting up to `timeout` [s] for the first one, and returns all messages so
  /// far in order of arrival.
  const std::vector<std::string>& Heard(double timeout = 0) {
    pollfd waiting{socket_, POLLIN, 0};
    for (int wait = static_cast<int>(timeout * 1000); poll(&waiting, 1, wait) > 0; wait = 0) {
      char text[4096];
      const ssize_t size = recv(socket_, text, sizeof(text), 0);
      if (size > 0) heard_.emplace_back(text, static_cast<size_t>(size));
    }
    return heard_;
  }
  /// Number of messages so far that are equal to this one.
  int Count(const std::string& message) {
    int count = 0;
    for (const std::string& one : Heard()) count += one == message;
    return count;
  }
  /// Receives until `message` has come `times` times; false when nothing comes for a minute.
  bool WaitFor(const std::string& message, int times = 1) {
    while (Count(message) < times) {
      const size_t before = heard_.size();
      if (Heard(60).size() == before) return false;
    }
    return true;
  }
  void Forget() { heard_.clear(); }

 private:
  TempFolder folder_;
  int socket_ = -1;
  std::vector<std::string> heard_;
};

}  // namespace vismap
