#pragma once

#include <utility>

#include "base/result.h"
#include "runtime/lcm_url.h"

namespace vismap {

/// Owns the file descriptor of a socket and closes it; -1 = none.
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

/// Opens a non-blocking connection to a hub, exchanges the greetings of the tcpq protocol, and
/// applies TuneTcp. Fails with the reason, or when it takes longer than `timeout` [s].
Result<Socket> ConnectToHub(const TcpAddress& hub, double timeout);

/// Sets the options for both ends of a connection: TCP_NODELAY, a keep-alive that detects a
/// vanished peer within half a minute, and within a computer a congestion control that does not
/// space packets.
void TuneTcp(int fd);

}  // namespace vismap
