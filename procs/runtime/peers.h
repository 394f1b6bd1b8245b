#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "runtime/bus.h"

namespace vismap {

/// What another process last said of itself on STATUS.
struct Peer {
  std::string process;  ///< which program
  std::string state;    ///< "starting", "ready", "waiting", "running" or "stopping"
  std::string message;
  int64_t start_utime = 0;  ///< a new one means that it was restarted
  double last_heard = 0;    ///< MonotonicSeconds
};

/// Who else is on the bus, from their STATUS messages.
class Peers {
 public:
  /// A peer silent for longer than this counts as gone [s]; long work in one handler delays its
  /// status.
  static constexpr double kMaxSilence = 5.0;

  /// Subscribes to STATUS. `bus` must outlive it.
  explicit Peers(Bus* bus);

  /// Some instance of this program has spoken lately and is not stopping.
  bool IsAlive(const std::string& process) const;
  /// Some instance of this program is alive and past kStarting.
  bool IsReady(const std::string& process) const;
  /// Those of `processes` that are not ready.
  std::vector<std::string> NotReady(const std::vector<std::string>& processes) const;
  /// By name of the instance.
  const std::map<std::string, Peer>& all() const { return peers_; }

 private:
  std::map<std::string, Peer> peers_;
};

}  // namespace vismap
