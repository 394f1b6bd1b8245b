#include "depth_segmenter/frame_detection_join.h"

#include <algorithm>
#include <utility>

namespace vismap {
namespace {

constexpr size_t kEntryBytes = 512;  // of a waiting message besides its data

size_t BytesOf(const rgbd_frame_t& frame) {
  return kEntryBytes + frame.source.size() + frame.depth.size() + frame.color.size();
}

size_t BytesOf(const detections_t& detections) {
  size_t bytes = kEntryBytes + detections.source.size();
  for (const detection_t& detection : detections.detections)
    bytes += sizeof(detection) + 16 + detection.runs.size() * sizeof(int32_t);
  return bytes;
}

}  // namespace

bool FrameDetectionJoin::IsWaiting(const FrameKey& key) const {
  return std::any_of(frames_.begin(), frames_.end(),
                     [&](const Waiting& w) { return KeyOf(w.frame) == key; });
}

void FrameDetectionJoin::AddFrame(const rgbd_frame_t& frame, double now) {
  if (IsWaiting(KeyOf(frame))) {
    ++counters_.frames_repeated;
    return;
  }
  const size_t bytes = BytesOf(frame);
  while (!frames_.empty() &&
         (frames_.size() >= limits_.capacity || frame_bytes_ + bytes > limits_.max_bytes / 4 * 3))
    DropOldestFrame();
  std::erase(released_without_,
             KeyOf(frame));  // since it arrived again, its detections may arrive again, too
  frames_.push_back({frame, now});
  frame_bytes_ += bytes;
}

void FrameDetectionJoin::AddDetections(const detections_t& detections, double now) {
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
  const size_t bytes = BytesOf(detections);
  while (!detections_.empty() && (detections_.size() >= limits_.capacity ||
                                  detection_bytes_ + bytes > limits_.max_bytes / 4))
    DropOldestDetections();
  detections_.emplace(key, WaitingDetections{detections, now});
  detections_order_.push_back(key);
  detection_bytes_ += bytes;
}

void FrameDetectionJoin::DropLate(double now) {
  while (!frames_.empty() && Waited(now) >= limits_.max_wait_s) DropOldestFrame();
  while (!detections_.empty() &&
         now - detections_.at(detections_order_.front()).arrival >= limits_.max_wait_s)
    DropOldestDetections();
}

std::optional<JoinedFrame> FrameDetectionJoin::Next(double now, double patience) {
  if (frames_.empty()) return std::nullopt;
  const FrameKey key = KeyOf(frames_.front().frame);
  const auto found = detections_.find(key);
  if (found == detections_.end() && Waited(now) < patience) return std::nullopt;
  const double frame_arrival = frames_.front().arrival;
  JoinedFrame joined{TakeOldestFrame(), std::nullopt};
  if (found == detections_.end()) {
    ++counters_.frames_without;
    RememberWithout(key);
    return joined;
  }
  joined.detections_after_s = std::max(0.0, found->second.arrival - frame_arrival);
  joined.detections = Take(found);
  return joined;
}

rgbd_frame_t FrameDetectionJoin::TakeOldestFrame() {
  rgbd_frame_t frame = std::move(frames_.front().frame);
  frames_.pop_front();
  frame_bytes_ -= BytesOf(frame);
  return frame;
}

detections_t FrameDetectionJoin::Take(std::map<FrameKey, WaitingDetections>::iterator detections) {
  std::erase(detections_order_, detections->first);
  detections_t message = std::move(detections->second.message);
  detections_.erase(detections);
  detection_bytes_ -= BytesOf(message);
  return message;
}

void FrameDetectionJoin::DropOldestFrame() {
  ++counters_.frames_dropped;
  RememberWithout(KeyOf(TakeOldestFrame()));
}

void FrameDetectionJoin::DropOldestDetections() {
  ++counters_.detections_dropped;
  Take(detections_.find(detections_order_.front()));
}

void FrameDetectionJoin::RememberWithout(const FrameKey& key) {
  released_without_.push_back(key);
  if (released_without_.size() > limits_.capacity) released_without_.pop_front();
}

}  // namespace vismap
