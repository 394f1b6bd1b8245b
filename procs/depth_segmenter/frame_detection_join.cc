#include "depth_segmenter/frame_detection_join.h"

#include <algorithm>
#include <utility>

namespace vismap {

bool FrameDetectionJoin::IsWaiting(const FrameKey& key) const {
  return std::any_of(frames_.begin(), frames_.end(),
                     [&](const Waiting& w) { return KeyOf(w.frame) == key; });
}

void FrameDetectionJoin::AddFrame(const rgbd_frame_t& frame, double now) {
  if (IsWaiting(KeyOf(frame))) {
    ++counters_.frames_repeated;
    return;
  }
  if (frames_.size() >= capacity_) {
    ++counters_.frames_dropped;
    RememberWithout(KeyOf(frames_.front().frame));
    frames_.pop_front();
  }
  std::erase(released_without_,
             KeyOf(frame));  // since it arrived again, its detections may arrive again, too
  frames_.push_back({frame, now});
}

void FrameDetectionJoin::AddDetections(const detections_t& detections) {
  const FrameKey key = KeyOf(detections);
  if (detections_.contains(key)) {
    ++counters_.detections_repeated;
    return;
  }
  if (std::find(released_without_.begin(), released_without_.end(), key) !=
      released_without_.end()) {
    ++counters_.detections_late;
    return;
  }
  if (detections_.size() >= capacity_) {
    ++counters_.detections_dropped;
    detections_.erase(detections_order_.front());
    detections_order_.pop_front();
  }
  detections_.emplace(key, detections);
  detections_order_.push_back(key);
}

std::optional<JoinedFrame> FrameDetectionJoin::Next(double now, double patience) {
  if (frames_.empty()) return std::nullopt;
  const FrameKey key = KeyOf(frames_.front().frame);
  const auto found = detections_.find(key);
  if (found == detections_.end() && Waited(now) < patience) return std::nullopt;
  JoinedFrame joined{std::move(frames_.front().frame), std::nullopt};
  frames_.pop_front();
  if (found == detections_.end()) {
    ++counters_.frames_without;
    RememberWithout(key);
    return joined;
  }
  joined.detections = std::move(found->second);
  detections_.erase(found);
  std::erase(detections_order_, key);
  return joined;
}

void FrameDetectionJoin::RememberWithout(const FrameKey& key) {
  released_without_.push_back(key);
  if (released_without_.size() > capacity_) released_without_.pop_front();
}

}  // namespace vismap
