#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>
#include <vismap/process_status_t.hpp>

#include "runtime/bus.h"

namespace vismap {

/// The latest STATUS of another process.
struct Peer {
  std::string process;  ///< name of the program, for example "map-server"
  std::string state;    ///< "starting", "ready", "waiting", "running" or "stopping"
  std::string message;
  int64_t start_utime = 0;  ///< changes when the process is restarted [us]
  double last_heard = 0;    ///< MonotonicSeconds
  std::string host;
  int pid = 0;
  std::vector<std::string> findings;  ///< what it says is wrong or suspect
};

/// The other processes on the bus, known by their STATUS messages.
class Peers {
 public:
  /// A process without STATUS for longer than this counts as not alive [s]. It is long, because a
  /// handler that works for long delays the STATUS.
  static constexpr double kMaxSilence = 5.0;

  /// Subscribes to STATUS. `bus` must outlive it.
  explicit Peers(Bus* bus);

  /// Whether an instance of this program has published STATUS lately and is not stopping.
  bool IsAlive(const std::string& process) const;
  /// Whether an instance of this program is alive and has left kStarting.
  bool IsReady(const std::string& process) const;
  /// The programs of `processes` of which no instance is ready.
  std::vector<std::string> NotReady(const std::vector<std::string>& processes) const;
  /// All peers, by the name of their instance. Of several with one name, that which was started
  /// last has the name, and the others "name (computer, pid N)", so that none hides another.
  const std::map<std::string, Peer>& all() const { return peers_; }

 private:
  std::string KeyOf(const process_status_t& status) const;

  std::map<std::string, Peer> peers_;
};

}  // namespace vismap
