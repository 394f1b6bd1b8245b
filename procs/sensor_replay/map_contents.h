#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "runtime/bus.h"
#include "runtime/peers.h"
#include "wire/frame_key.h"

namespace vismap {

/// Asks the map server which frames its map holds: after a restart it may lack frames that it had
/// committed.
class MapContents {
 public:
  /// Subscribes. `bus` and `peers` must outlive it.
  MapContents(Bus* bus, const Peers* peers);

  /// True once after each restart of a map server, as its STATUS tells.
  bool ServerRestarted();

  /// Sends the question, unless the last one is younger than a second.
  void Request();
  bool requested() const { return requested_; }

  /// True once for each answer to Ask; `Holds` then speaks of the map at that time.
  bool ConsumeAnswer();
  bool Holds(const FrameKey& frame) const { return frames_.contains(frame); }
  size_t size() const { return frames_.size(); }

 private:
  Result<void> OnReply(const std::string& requester, int64_t request_id, bool ok,
                       const std::string& payload);

  Bus* bus_;
  const Peers* peers_;
  std::map<std::string, int64_t> start_utimes_;  // of the map servers, by name
  bool requested_ = false, answered_ = false;
  double request_time_ = 0;  // MonotonicSeconds
  int64_t request_id_ = 0;
  std::set<FrameKey> frames_;
};

}  // namespace vismap
