#include "sensor_replay/lockstep_window.h"

#include <algorithm>

#include "base/require.h"

namespace vismap {

bool LockstepWindow::MaySend(const FrameKey& key) const {
  return HasRoom() && std::all_of(in_flight_.begin(), in_flight_.end(), [&](const Frame& frame) {
           return frame.key.camera_id == key.camera_id;
         });
}

void LockstepWindow::Sent(size_t index, const FrameKey& key, double now) {
  Require(HasRoom(), "a frame is sent only when the window has room");
  if (in_flight_.empty()) last_progress_ = now;
  in_flight_.push_back({index, key, now});
}

bool LockstepWindow::Commit(const FrameKey& key, double now) {
  const auto found = std::find_if(in_flight_.begin(), in_flight_.end(),
                                  [&](const Frame& frame) { return frame.key == key; });
  if (found == in_flight_.end()) return false;
  in_flight_.erase(found);
  last_progress_ = now;
  return true;
}

std::optional<size_t> LockstepWindow::NextResend(double now) {
  if (now - last_progress_ < resend_after_) return std::nullopt;
  for (Frame& frame : in_flight_) {
    if (now - frame.sent < resend_after_) continue;
    frame.sent = now;
    return frame.index;
  }
  return std::nullopt;
}

bool LockstepWindow::IsInFlight(const FrameKey& key) const {
  return std::any_of(in_flight_.begin(), in_flight_.end(),
                     [&](const Frame& frame) { return frame.key == key; });
}

}  // namespace vismap
