#include "runtime/lcm_url.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <charconv>
#include <cstdlib>
#include <string_view>

#include "base/format.h"
#include "runtime/tcp_socket.h"

namespace vismap {
namespace {

constexpr int kReceiveBuffer = 4 << 20;

template <typename Number>
bool ParseWhole(std::string_view text, Number* number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
  return error == std::errc() && end == text.data() + text.size();
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
                "': expected a numeric address such as 127.0.0.1:7700 (LCM does not resolve host "
                "names, but connects to this computer instead)");
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
        return Fail("--lcm-url '" + url + "': recv_buf_size must be a number");
      }
    }
  }
  return parsed;
}

Result<void> ProbeHub(const TcpAddress& hub, double timeout) {
  const Result<Socket> connection = ConnectToHub(hub, timeout);
  if (connection) return {};
  return Fail(hub.host + ":" + std::to_string(hub.port) + ": " + connection.error().message);
}

Result<void> ProbeReceiveBuffer(int bytes) {
  const Socket probe(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  setsockopt(probe.fd(), SOL_SOCKET, SO_RCVBUF, &bytes, sizeof(bytes));
  int effective = 0;  // the kernel reports twice the granted size
  socklen_t size = sizeof(effective);
  getsockopt(probe.fd(), SOL_SOCKET, SO_RCVBUF, &effective, &size);
  if (effective / 2 >= bytes) return {};
  return Fail("the kernel grants a receive buffer of " + FormatBytes(effective / 2) +
              " instead of " + FormatBytes(bytes) +
              ", so large messages will be lost; run: sudo sysctl -w net.core.rmem_max=33554432");
}

}  // namespace vismap
