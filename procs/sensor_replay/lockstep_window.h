#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "wire/frame_key.h"

namespace vismap {

/// Which frames of a lockstep replay are on their way: at most `window` frames are sent ahead of
/// the oldest that the map server has not committed, and when no commit comes for `resend_after`,
/// those are sent again. Does not look at a clock: times [s] are passed in.
class LockstepWindow {
 public:
  LockstepWindow(int window, double resend_after) : window_(window), resend_after_(resend_after) {}

  /// Whether another new frame may be sent.
  bool HasRoom() const { return static_cast<int>(open_.size()) < window_; }

  /// Whether this new frame may be sent: there is room, and no frame of another camera is open. The
  /// map server keeps the order of one camera's frames by after_utime; across cameras only this
  /// does.
  bool MaySend(const FrameKey& key) const;

  /// A new frame `index` is sent now. The window must have room.
  void Sent(size_t index, const FrameKey& key, double now);

  /// A commit came. True when the frame was waited for; false for repeats and strangers.
  bool Commit(const FrameKey& key, double now);

  /// The next frame to send again, if one is due; ask until none is. Frames come in their order.
  std::optional<size_t> NextResend(double now);

  /// Forgets all frames that are on their way: they will be sent as new ones.
  void Clear() { open_.clear(); }

  /// Whether commits have been missing for so long that frames are due again.
  bool Stalled(double now) const { return !open_.empty() && now - last_progress_ >= resend_after_; }
  bool IsInFlight(const FrameKey& key) const;

  bool empty() const { return open_.empty(); }
  size_t open() const { return open_.size(); }

 private:
  struct Open {
    size_t index;
    FrameKey key;
    double sent;
  };
  int window_;
  double resend_after_;
  double last_progress_ = 0;
  std::deque<Open> open_;  // in the order of sending
};

}  // namespace vismap
