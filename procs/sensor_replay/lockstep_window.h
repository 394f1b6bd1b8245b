#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "wire/frame_key.h"

namespace vismap {

/// The frames in flight of a lockstep replay: those that were sent and not yet committed by the map
/// server. At most `window` frames are in flight. When no commit arrives for `resend_after` [s],
/// they are due to be sent again. It has no clock of its own: callers pass the current time `now`
/// [s].
class LockstepWindow {
 public:
  LockstepWindow(int window, double resend_after) : window_(window), resend_after_(resend_after) {}

  /// Whether fewer than `window` frames are in flight.
  bool HasRoom() const { return static_cast<int>(in_flight_.size()) < window_; }

  /// Whether this new frame may be sent: there is room, and no frame of another camera is in
  /// flight. after_utime preserves the order of the frames of one camera only, so this rule
  /// preserves it across cameras.
  bool MaySend(const FrameKey& key) const;

  /// Adds the new frame number `index`, which is sent now. The window must have room.
  void Sent(size_t index, const FrameKey& key, double now);

  /// Removes a committed frame. Returns false when it was not in flight, as for a repeated commit
  /// or a frame of another source.
  bool Commit(const FrameKey& key, double now);

  /// The number of the next frame that is due to be sent again; nullopt when none is. Call it until
  /// it returns nullopt; it returns the frames in the order of sending.
  std::optional<size_t> NextResend(double now);

  /// Removes all frames, so that they can be sent as new ones.
  void Clear() { in_flight_.clear(); }

  /// Whether no commit has arrived for `resend_after` although frames are in flight.
  bool Stalled(double now) const {
    return !in_flight_.empty() && now - last_progress_ >= resend_after_;
  }
  bool IsInFlight(const FrameKey& key) const;

  bool empty() const { return in_flight_.empty(); }
  size_t in_flight() const { return in_flight_.size(); }

 private:
  struct Frame {
    size_t index;
    FrameKey key;
    double sent;  // [s]
  };
  int window_;
  double resend_after_;
  double last_progress_ = 0;
  std::deque<Frame> in_flight_;  // in the order of sending
};

}  // namespace vismap
