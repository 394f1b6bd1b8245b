#pragma once

#include <utility>

#include "base/result.h"
#include "runtime/lcm_url.h"

namespace vismap {

/// A file descriptor that closes itself; -1 = none.
class Socket {
 public:
  Socket() = default;
  explicit Socket(int fd) : fd_(fd) {}
  ~Socket() { Close(); }
  Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }

  int fd() const { return fd_; }
  bool open() const { return fd_ >= 0; }
  void Close();

 private:
  int fd_ = -1;
};

/// A non-blocking connection to a hub that has greeted us and has our greeting, without delay of
/// small pieces and with a watch for peers that vanish. Fails with the reason when that takes
/// longer than `timeout` [s].
Result<Socket> ConnectToHub(const TcpAddress& hub, double timeout);

/// Options that both ends of a connection set: TCP_NODELAY and keep-alive within half a minute.
void TuneTcp(int fd);

}  // namespace vismap
