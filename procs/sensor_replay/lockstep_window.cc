#include "sensor_replay/lockstep_window.h"

#include <algorithm>

#include "base/require.h"

namespace vismap {

bool LockstepWindow::MaySend(const FrameKey& key) const {
  return HasRoom() && std::all_of(open_.begin(), open_.end(), [&](const Open& open) {
           return open.key.camera_id == key.camera_id;
         });
}

void LockstepWindow::Sent(size_t index, const FrameKey& key, double now) {
  Require(HasRoom(), "a frame is sent only when the window has room");
  if (open_.empty()) last_progress_ = now;
  open_.push_back({index, key, now});
}

bool LockstepWindow::Commit(const FrameKey& key, double now) {
  const auto found =
      std::find_if(open_.begin(), open_.end(), [&](const Open& open) { return open.key == key; });
  if (found == open_.end()) return false;
  open_.erase(found);
  last_progress_ = now;
  return true;
}

std::optional<size_t> LockstepWindow::NextResend(double now) {
  if (now - last_progress_ < resend_after_) return std::nullopt;
  for (Open& open : open_) {
    if (now - open.sent < resend_after_) continue;
    open.sent = now;
    return open.index;
  }
  return std::nullopt;
}

bool LockstepWindow::IsInFlight(const FrameKey& key) const {
  return std::any_of(open_.begin(), open_.end(), [&](const Open& open) { return open.key == key; });
}

}  // namespace vismap
