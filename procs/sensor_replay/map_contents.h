#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "runtime/bus.h"
#include "runtime/peers.h"
#include "wire/frame_key.h"

namespace vismap {

/// Requests from the map server the list of frames in its map. After a restart, the map may lack
/// frames that were committed before.
class MapContents {
 public:
  /// Subscribes to MAP_REPLY. `bus` and `peers` must outlive the object.
  MapContents(Bus* bus, const Peers* peers);

  /// Returns true once after each restart of a map server, which is detected by its STATUS.
  bool ServerRestarted();

  /// Sends the request. Does nothing within a second after an unanswered one.
  void Request();
  /// Whether a request has not been answered yet.
  bool requested() const { return requested_; }

  /// Returns true once for each answer; Holds() and size() then describe the map at the time of the
  /// answer.
  bool ConsumeAnswer();
  /// Whether the map has this frame.
  bool Holds(const FrameKey& frame) const { return frames_.contains(frame); }
  /// The poses of all frames of the map, as PoseDigest.
  const std::map<FrameKey, std::string>& frames() const { return frames_; }
  /// Number of frames in the map.
  size_t size() const { return frames_.size(); }

 private:
  Result<void> OnReply(const std::string& requester, int64_t request_id, bool ok,
                       const std::string& payload);

  Bus* bus_;
  const Peers* peers_;
  std::map<std::string, int64_t> start_utimes_;  // start_utime of each map server, by name
  bool requested_ = false, answered_ = false;
  double request_time_ = 0;  // MonotonicSeconds
  int64_t request_id_ = 0;
  std::map<FrameKey, std::string> frames_;
};

}  // namespace vismap
