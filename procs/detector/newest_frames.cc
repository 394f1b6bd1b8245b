#include "detector/newest_frames.h"

#include <algorithm>
#include <utility>

namespace vismap {

namespace {
size_t BytesOf(const rgbd_frame_t& frame) {
  return 1024 + frame.source.size() + frame.depth.size() + frame.color.size();
}
}  // namespace

std::optional<rgbd_frame_t> NewestFrames::Add(const rgbd_frame_t& frame) {
  size_t others = 0;  // bytes of the frames of the other cameras
  for (const rgbd_frame_t& waiting : frames_)
    others += waiting.camera_id == frame.camera_id ? 0 : BytesOf(waiting);
  if (others > 0 && others + BytesOf(frame) > max_bytes_) return frame;
  const auto older = std::find_if(frames_.begin(), frames_.end(), [&](const rgbd_frame_t& waiting) {
    return waiting.camera_id == frame.camera_id;
  });
  if (older != frames_.end()) return std::exchange(*older, frame);  // the camera keeps its turn
  if (frames_.size() >= max_cameras_) return frame;
  frames_.push_back(frame);
  return std::nullopt;
}

std::optional<rgbd_frame_t> NewestFrames::Next() {
  if (frames_.empty()) return std::nullopt;
  rgbd_frame_t frame = std::move(frames_.front());
  frames_.pop_front();
  return frame;
}

bool NewestFrames::Waits(const FrameKey& key) const {
  return std::any_of(frames_.begin(), frames_.end(),
                     [&](const rgbd_frame_t& frame) { return KeyOf(frame) == key; });
}

}  // namespace vismap
