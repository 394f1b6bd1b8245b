#include "runtime/lcm_url.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>

namespace vismap {
namespace {

constexpr int kReceiveBuffer = 4 << 20;

/// A socket that closes itself.
struct Socket {
  explicit Socket(int type) : fd(socket(AF_INET, type | SOCK_CLOEXEC, 0)) {}
  ~Socket() {
    if (fd >= 0) close(fd);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int fd;
};

bool WaitUntil(int fd, short events, double timeout) {
  pollfd waiting{fd, events, 0};
  return poll(&waiting, 1, static_cast<int>(timeout * 1000)) == 1;
}

template <typename Number>
bool ParseWhole(std::string_view text, Number* number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
  return error == std::errc() && end == text.data() + text.size();
}

Result<void> Connect(int fd, const TcpAddress& hub, double timeout) {
  fcntl(fd, F_SETFL, O_NONBLOCK);
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

}  // namespace

std::string DefaultLcmUrl() {
  const char* url = std::getenv("LCM_DEFAULT_URL");
  return url != nullptr && *url != '\0' ? url : "tcpq://127.0.0.1:7700";
}

Result<TcpAddress> ParseTcpAddress(const std::string& text) {
  const size_t colon = text.find(':');
  TcpAddress address{text.substr(0, colon), 7700};
  in_addr parsed{};
  if (inet_pton(AF_INET, address.host.c_str(), &parsed) != 1) {
    return Fail("address '" + text +
                "': expected numbers such as 127.0.0.1:7700 (LCM takes names for this computer)");
  }
  if (colon != std::string::npos &&
      !ParseWhole(std::string_view(text).substr(colon + 1), &address.port)) {
    return Fail("address '" + text + "': expected a port from 0 to 65535 after the colon");
  }
  return address;
}

Result<LcmUrl> ParseLcmUrl(const std::string& url) {
  const size_t slashes = url.find("://");
  if (slashes == std::string::npos) {
    return Fail("--lcm-url '" + url +
                "': expected PROVIDER://..., for example tcpq://127.0.0.1:7700");
  }
  LcmUrl parsed{url, url.substr(0, slashes), {}, 0};
  const std::string rest = url.substr(slashes + 3);
  const size_t question = rest.find('?');
  if (parsed.provider == "tcpq") {
    const std::string network = rest.substr(0, question);
    const Result<TcpAddress> hub = ParseTcpAddress(network.empty() ? "127.0.0.1:7700" : network);
    if (!hub) return Fail("--lcm-url '" + url + "': " + hub.error().message);
    parsed.hub = *hub;
  } else if (parsed.provider == "udpm") {
    const std::string key = "recv_buf_size=";
    const size_t given = rest.find(key);
    if (given == std::string::npos) {
      parsed.receive_buffer = kReceiveBuffer;
      parsed.text +=
          (question == std::string::npos ? "?" : "&") + key + std::to_string(kReceiveBuffer);
    } else {
      const std::string number =
          rest.substr(given + key.size(), rest.find('&', given) - given - key.size());
      if (!ParseWhole(number, &parsed.receive_buffer)) {
        return Fail("--lcm-url '" + url + "': recv_buf_size is not a number");
      }
    }
  }
  return parsed;
}

Result<void> ProbeHub(const TcpAddress& hub, double timeout) {
  const std::string where = hub.host + ":" + std::to_string(hub.port) + ": ";
  const Socket probe(SOCK_STREAM);
  if (probe.fd < 0) return Fail(where + std::strerror(errno));
  if (const Result<void> connected = Connect(probe.fd, hub, timeout); !connected) {
    return Fail(where + connected.error().message);
  }
  const std::array<uint32_t, 2> hello = {htonl(0x287617fb), htonl(0x0100)};
  if (send(probe.fd, hello.data(), sizeof(hello), MSG_NOSIGNAL) != sizeof(hello)) {
    return Fail(where + std::strerror(errno));
  }
  std::array<uint32_t, 2> answer{};
  size_t have = 0;
  while (have < sizeof(answer)) {
    if (!WaitUntil(probe.fd, POLLIN, timeout))
      return Fail(where + "connected, but no LCM hub answers there");
    const ssize_t got =
        recv(probe.fd, reinterpret_cast<char*>(answer.data()) + have, sizeof(answer) - have, 0);
    if (got <= 0) return Fail(where + "closed the connection");
    have += static_cast<size_t>(got);
  }
  if (ntohl(answer[0]) != 0x287617fa)
    return Fail(where + "something that is no LCM hub answers there");
  return {};
}

Result<void> ProbeReceiveBuffer(int bytes) {
  const Socket probe(SOCK_DGRAM);
  setsockopt(probe.fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof(bytes));
  int effective = 0;  // the kernel reports twice what it grants
  socklen_t size = sizeof(effective);
  getsockopt(probe.fd, SOL_SOCKET, SO_RCVBUF, &effective, &size);
  if (effective / 2 >= bytes) return {};
  return Fail("the kernel grants a receive buffer of " + std::to_string(effective / 2) +
              " bytes instead of " + std::to_string(bytes) +
              ", large messages will be lost; run: sudo sysctl -w net.core.rmem_max=33554432");
}

}  // namespace vismap
