#include "map_server/frame_intake.h"

namespace vismap {

namespace {
constexpr size_t kMaxSkipped = 100000;
}  // namespace

bool FrameIntake::SetMap(const std::string& map_id) {
  if (map_id == map_id_) return false;
  map_id_ = map_id;
  order_.Clear();
  skipped_.clear();
  skipped_order_.clear();
  return true;
}

void FrameIntake::Add(const segmented_frame_t& message, double now) {
  order_.Add(KeyOf(message.frame), message.frame.after_utime, message, BytesOf(message), now);
}

std::optional<segmented_frame_t> FrameIntake::Next(const MapSession& session) {
  return order_.Next([&](const FrameKey& frame) {
    return session.Contains(frame.camera_id, frame.utime) || skipped_.contains(frame);
  });
}

void FrameIntake::Skip(const FrameKey& frame) {
  if (!skipped_.insert(frame).second) return;
  skipped_order_.push_back(frame);
  if (skipped_order_.size() <= kMaxSkipped) return;
  skipped_.erase(skipped_order_.front());
  skipped_order_.pop_front();
}

size_t BytesOf(const segmented_frame_t& message) {
  constexpr size_t kOverhead = 256;  // of the entry and of the vectors
  return sizeof(message) + kOverhead + message.source.size() + message.frame.source.size() +
         message.frame.depth.size() + message.frame.color.size() + message.labels.size() +
         message.segments.size() * sizeof(frame_segment_t);
}

}  // namespace vismap
