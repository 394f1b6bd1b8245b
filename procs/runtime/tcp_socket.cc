#include "runtime/tcp_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "runtime/tcpq_records.h"

namespace vismap {
namespace {

bool WaitUntil(int fd, short events, double timeout) {
  pollfd waiting{fd, events, 0};
  return poll(&waiting, 1, static_cast<int>(timeout * 1000)) == 1;
}

Result<void> Connect(int fd, const TcpAddress& hub, double timeout) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(hub.port);
  inet_pton(AF_INET, hub.host.c_str(), &address.sin_addr);
  if (connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0) return {};
  if (errno != EINPROGRESS) return Fail(std::strerror(errno));
  if (!WaitUntil(fd, POLLOUT, timeout)) return Fail("no answer");
  int error = 0;
  socklen_t size = sizeof(error);
  getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) return Fail(std::strerror(error));
  return {};
}

Result<void> Greet(int fd, double timeout) {
  const std::vector<uint8_t> hello = TcpqHello(TcpqMagic::kClient);
  if (send(fd, hello.data(), hello.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(hello.size())) {
    return Fail(std::strerror(errno));
  }
  std::array<uint32_t, 2> answer{};
  size_t have = 0;
  while (have < sizeof(answer)) {
    if (!WaitUntil(fd, POLLIN, timeout))
      return Fail("the connection was accepted, but no LCM hub answers");
    const ssize_t got =
        recv(fd, reinterpret_cast<char*>(answer.data()) + have, sizeof(answer) - have, 0);
    if (got <= 0) return Fail("the connection was closed");
    have += static_cast<size_t>(got);
  }
  if (ntohl(answer[0]) == static_cast<uint32_t>(TcpqMagic::kHub)) return {};
  return Fail("the program that answers is not an LCM hub");
}

void SetOption(int fd, int level, int option, int value) {
  setsockopt(fd, level, option, &value, sizeof(value));
}

// Whether both ends are on this computer.
bool IsLoopback(int fd) {
  sockaddr_in peer{}, own{};
  socklen_t peer_size = sizeof(peer), own_size = sizeof(own);
  if (getpeername(fd, reinterpret_cast<sockaddr*>(&peer), &peer_size) != 0 ||
      getsockname(fd, reinterpret_cast<sockaddr*>(&own), &own_size) != 0)
    return false;
  if (peer.sin_family != AF_INET || own.sin_family != AF_INET) return false;
  return ntohl(peer.sin_addr.s_addr) >> 24 == 127 || peer.sin_addr.s_addr == own.sin_addr.s_addr;
}

}  // namespace

void Socket::Close() {
  if (fd_ >= 0) close(std::exchange(fd_, -1));
}

void TuneTcp(int fd) {
  SetOption(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  SetOption(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  SetOption(fd, IPPROTO_TCP, TCP_KEEPIDLE, 10);
  SetOption(fd, IPPROTO_TCP, TCP_KEEPINTVL, 5);
  SetOption(fd, IPPROTO_TCP, TCP_KEEPCNT, 3);
  // BBR, the default of some computers, spaces the packets by the speed that it has measured.
  // Within a computer, this delays an image by milliseconds.
  constexpr std::string_view kUnspaced = "cubic";
  if (IsLoopback(fd))
    setsockopt(fd, IPPROTO_TCP, TCP_CONGESTION, kUnspaced.data(), kUnspaced.size());
}

Result<Socket> ConnectToHub(const TcpAddress& hub, double timeout) {
  Socket made(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!made.open()) return Fail(std::strerror(errno));
  if (const Result<void> connected = Connect(made.fd(), hub, timeout); !connected) {
    return tl::unexpected(connected.error());
  }
  TuneTcp(made.fd());
  if (const Result<void> greeted = Greet(made.fd(), timeout); !greeted)
    return tl::unexpected(greeted.error());
  return made;
}

}  // namespace vismap
