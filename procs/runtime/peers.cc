#include "runtime/peers.h"

#include <algorithm>

#include "runtime/clock.h"
#include "runtime/log.h"
#include "wire/fingerprint.h"

namespace vismap {
namespace {

constexpr size_t kMaxPeers = 1024;
constexpr size_t kMaxText = 255;  // of what is kept of a peer

bool PeerIsAlive(const Peer& peer) {
  return peer.state != "stopping" && MonotonicSeconds() - peer.last_heard < Peers::kMaxSilence;
}

}  // namespace

Peers::Peers(Bus* bus) {
  bus->Subscribe<process_status_t>(kStatusChannel, [this](const process_status_t& status) {
    const std::string key = KeyOf(status);
    if (peers_.size() >= kMaxPeers && !peers_.contains(key)) return;
    if (status.source.size() > kMaxText || status.process.size() > kMaxText ||
        status.host.size() > kMaxText)
      return;
    peers_[key] = {status.process,
                   status.state.substr(0, kMaxText),
                   status.message.substr(0, 4 * kMaxText),
                   status.start_utime,
                   MonotonicSeconds(),
                   status.host,
                   status.pid,
                   status.findings};
    if (status.types_fingerprint != TypesFingerprint()) {
      LogWarningRateLimited("fingerprint",
                            status.source + " on " + status.host +
                                " uses other message types (version " + status.version +
                                ") than this process; they cannot exchange all messages");
    }
  });
}

std::string Peers::KeyOf(const process_status_t& status) const {
  const auto holder = peers_.find(status.source);
  if (holder == peers_.end() || status.start_utime >= holder->second.start_utime)
    return status.source;
  return status.source + " (" + status.host + ", pid " + std::to_string(status.pid) + ")";
}

bool Peers::IsAlive(const std::string& process) const {
  return std::any_of(peers_.begin(), peers_.end(), [&](const auto& entry) {
    return entry.second.process == process && PeerIsAlive(entry.second);
  });
}

bool Peers::IsReady(const std::string& process) const {
  return std::any_of(peers_.begin(), peers_.end(), [&](const auto& entry) {
    return entry.second.process == process && PeerIsAlive(entry.second) &&
           entry.second.state != "starting";
  });
}

std::vector<std::string> Peers::NotReady(const std::vector<std::string>& processes) const {
  std::vector<std::string> missing;
  std::copy_if(processes.begin(), processes.end(), std::back_inserter(missing),
               [this](const std::string& process) { return !IsReady(process); });
  return missing;
}

}  // namespace vismap
