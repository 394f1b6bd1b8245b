#include "runtime/self_check.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include "base/format.h"
#include "runtime/log.h"
#include "runtime/tcp_socket.h"

namespace vismap {
namespace {

/// The network interface of the most specific route to an address in the routing table.
std::optional<std::string> InterfaceFor(in_addr address) {
  std::ifstream table("/proc/net/route");
  std::optional<std::string> best;
  uint32_t best_mask = 0;
  std::string line;
  std::getline(table, line);  // the header line
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string name, ignored;
    uint32_t destination = 0, mask = 0;
    words >> name >> std::hex >> destination >> ignored >> ignored >> ignored >> ignored >>
        ignored >> mask;
    if (!words || (address.s_addr & mask) != destination) continue;
    if (best && ntohl(mask) < ntohl(best_mask)) continue;
    best = name;
    best_mask = mask;
  }
  return best;
}

CheckResult CheckRoute(const LcmUrl& url) {
  CheckResult result{"multicast route", false, ""};
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(7667);
  const size_t begin = url.text.find("//") + 2;
  const std::string host = url.text.substr(begin, url.text.find_first_of(":?/", begin) - begin);
  if (inet_pton(AF_INET, host.c_str(), &group.sin_addr) != 1) {
    inet_pton(AF_INET, "239.255.76.67", &group.sin_addr);  // LCM's default
  }
  const Socket probe(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (connect(probe.fd(), reinterpret_cast<sockaddr*>(&group), sizeof(group)) != 0) {
    result.found = std::string("there is none (") + std::strerror(errno) +
                   "); run: sudo ip link set lo multicast on; sudo ip route add 224.0.0.0/4 dev lo";
    return result;
  }
  result.ok = true;
  result.found = "through " + InterfaceFor(group.sin_addr).value_or("an unknown interface");
  return result;
}

}  // namespace

std::string HubCommand(const LcmUrl& url) {
  return "vismap-hub --listen " + url.hub.host + ":" + std::to_string(url.hub.port);
}

std::vector<std::string> BusProblems(const LcmUrl& url) {
  std::vector<std::string> problems;
  if (url.provider == "tcpq") return problems;
  for (const CheckResult& check : CheckBus(url, 0)) {
    if (!check.ok) problems.push_back(check.what + ": " + check.found);
  }
  return problems;
}

void WarnAboutBus(const LcmUrl& url) {
  for (const std::string& problem : BusProblems(url)) LogWarning(problem);
}

std::vector<CheckResult> CheckBus(const LcmUrl& url, double timeout) {
  if (url.provider == "tcpq") {
    const Result<Socket> hub = ConnectToHub(url.hub, timeout);
    return {{"hub", hub.has_value(),
             hub ? "it answers at " + url.text
                 : "there is none at " + url.text + " (" + hub.error().message +
                       "); start one with: " + HubCommand(url)}};
  }
  if (url.provider != "udpm") return {};
  const Result<void> buffer = ProbeReceiveBuffer(url.receive_buffer);
  return {
      CheckRoute(url),
      {"receive buffer", buffer.has_value(),
       buffer ? "the kernel grants " + FormatBytes(url.receive_buffer) : buffer.error().message}};
}

}  // namespace vismap
