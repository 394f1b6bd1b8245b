#include "map_server/frame_intake.h"

namespace vismap {

namespace {
constexpr size_t kMaxSkipped = 100000;
}  // namespace

void FrameIntake::SetMap(const std::string& map_id) {
  if (map_id == map_id_) return;
  map_id_ = map_id;
  order_.Clear();
  skipped_.clear();
}

bool FrameIntake::Add(const segmented_frame_t& message) {
  return order_.Add(KeyOf(message.frame), message.frame.after_utime, message);
}

std::optional<segmented_frame_t> FrameIntake::Next(const MapSession& session) {
  return order_.Next([&](const FrameKey& frame) {
    return session.Contains(frame.camera_id, frame.utime) || skipped_.contains(frame);
  });
}

void FrameIntake::Skip(const FrameKey& frame) {
  if (skipped_.size() < kMaxSkipped) skipped_.insert(frame);
}

}  // namespace vismap
