#include "viewer/evidence_store.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "viewer/camera_watch.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

constexpr double kMetresPerUnit = 0.25, kRadiansPerUnit = 20 * std::numbers::pi / 180;
constexpr int kMostDepthColumns = 80;
constexpr double kMillimetre = 0.001;

uint16_t Millimetres(double depth_m) {
  const double steps = std::round(depth_m / kMillimetre);
  return steps >= 1 && steps < 65535 ? static_cast<uint16_t>(steps) : 0;  // also for NaN
}

int StepOf(const PinholeCamera& camera) {
  return (camera.width + kMostDepthColumns - 1) / kMostDepthColumns;
}

Image<uint16_t> SampleDepth(const Image<float>& depth_m, int step) {
  Image<uint16_t> sampled((depth_m.width() + step - 1) / step,
                          (depth_m.height() + step - 1) / step);
  for (int v = 0; v < sampled.height(); ++v) {
    for (int u = 0; u < sampled.width(); ++u)
      sampled(v, u) = Millimetres(static_cast<double>(depth_m(v * step, u * step)));
  }
  return sampled;
}

Image<uint16_t> SampleDepth(const SensorFrame& frame, int step) {
  if (frame.depth.empty()) return SampleDepth(frame.depth_m, step);
  const int width = frame.depth.width(), height = frame.depth.height();
  Image<uint16_t> sampled((width + step - 1) / step, (height + step - 1) / step);
  for (int v = 0; v < sampled.height(); ++v) {
    for (int u = 0; u < sampled.width(); ++u) {
      const uint16_t steps = frame.depth(v * step, u * step);
      if (steps != 65535) sampled(v, u) = Millimetres(steps * frame.depth_unit_m);
    }
  }
  return sampled;
}

}  // namespace

size_t EvidenceFrame::bytes() const {
  return sizeof *this + jpeg.size() + 2 * depth_mm.size() + labels.size() +
         segments.size() * sizeof(Segment);
}

Result<EvidenceFramePtr> MakeEvidenceFrame(const segmented_frame_t& message) {
  Result<std::vector<uint8_t>> jpeg = JpegOf(message.frame);
  if (!jpeg) return tl::unexpected(jpeg.error());
  const Result<SensorFrame> sensor = Decode(message.frame);
  if (!sensor) return tl::unexpected(sensor.error());
  auto frame = std::make_shared<EvidenceFrame>();
  frame->header = sensor->header;
  frame->jpeg = std::move(*jpeg);
  frame->depth_step = StepOf(sensor->header.camera);
  frame->depth_mm = SampleDepth(*sensor, frame->depth_step);
  frame->labels = message.labels;
  for (const frame_segment_t& segment : message.segments) {
    const bool named = segment.class_id > 0 && segment.class_id <= 65535;
    frame->segments.push_back({segment.detection,
                               named ? static_cast<ClassId>(segment.class_id) : ClassId::kUnknown,
                               segment.score});
  }
  return EvidenceFramePtr(std::move(frame));
}

std::shared_ptr<EvidenceFrame> MakeEvidenceFrame(const SegmentedFrame& segmented,
                                                 std::vector<uint8_t> jpeg,
                                                 std::vector<uint8_t> labels) {
  const RgbdFrame& sensor = segmented.frame;
  auto frame = std::make_shared<EvidenceFrame>();
  frame->header = sensor.header;
  frame->jpeg = std::move(jpeg);
  frame->depth_step = StepOf(frame->header.camera);
  frame->depth_mm = SampleDepth(
      sensor.measured_depth.empty() ? sensor.depth : sensor.measured_depth, frame->depth_step);
  frame->labels = std::move(labels);
  for (const FrameSegment& segment : segmented.segments) {
    const auto detection = static_cast<int32_t>(segment.detection);
    frame->segments.push_back({detection, segment.class_id, segment.score});
  }
  return frame;
}

double ViewDistance(const FrameHeader& a, const FrameHeader& b) {
  const double metres = (a.T_W_C.translation() - b.T_W_C.translation()).norm();
  const double cosine = ((a.T_W_C.linear().transpose() * b.T_W_C.linear()).trace() - 1) / 2;
  return metres / kMetresPerUnit + std::acos(std::clamp(cosine, -1.0, 1.0)) / kRadiansPerUnit;
}

bool EvidenceStore::Wants(const FrameHeader& header) const {
  return max_bytes_ > 0 &&
         std::all_of(frames_.begin(), frames_.end(), [&](const EvidenceFramePtr& kept) {
           const bool same = kept->header.utime == header.utime;
           return (!same && std::abs(header.utime - kept->header.utime) > renew_after_) ||
                  ViewDistance(kept->header, header) >= distance_;
         });
}

void EvidenceStore::Add(EvidenceFramePtr frame) {
  if (!Wants(frame->header) || frame->bytes() > max_bytes_) return;
  std::erase_if(frames_, [&](const EvidenceFramePtr& kept) {
    const bool replaced = ViewDistance(kept->header, frame->header) < distance_;
    if (replaced) bytes_ -= kept->bytes();
    return replaced;
  });
  bytes_ += frame->bytes();
  frames_.push_back(std::move(frame));
  if (bytes_ > max_bytes_ || frames_.size() > kMostFrames) Thin();
}

void EvidenceStore::Clear() { *this = EvidenceStore(max_bytes_, renew_after_); }

EvidenceStore EvidenceStore::Until(int64_t map_frames) const {
  EvidenceStore part = *this;
  std::erase_if(part.frames_, [&](const EvidenceFramePtr& frame) {
    const bool later = frame->map_frames > map_frames;
    if (later) part.bytes_ -= frame->bytes();
    return later;
  });
  return part;
}

// Makes room for a fifth of what may be kept, so that it is seldom called.
void EvidenceStore::Thin() {
  constexpr double kGrowth = 1.2, kShareLeft = 0.8;
  const auto most_bytes = static_cast<size_t>(kShareLeft * static_cast<double>(max_bytes_));
  const auto most_frames = static_cast<size_t>(kShareLeft * kMostFrames);
  while (frames_.size() > 1 && (bytes_ > most_bytes || frames_.size() > most_frames)) {
    distance_ *= kGrowth;
    std::vector<EvidenceFramePtr> kept;  // from the newest to the oldest
    bytes_ = 0;
    for (auto frame = frames_.rbegin(); frame != frames_.rend(); ++frame) {
      const bool differs = std::all_of(kept.begin(), kept.end(), [&](const auto& other) {
        return ViewDistance((*frame)->header, other->header) >= distance_;
      });
      if (!differs) continue;
      bytes_ += (*frame)->bytes();
      kept.push_back(*frame);
    }
    frames_.assign(kept.rbegin(), kept.rend());
  }
}

EvidenceFramePtr EvidenceStore::Find(CameraId camera, int64_t utime) const {
  const auto found = std::find_if(frames_.begin(), frames_.end(), [&](const auto& frame) {
    return frame->header.camera_id == camera && frame->header.utime == utime;
  });
  return found == frames_.end() ? nullptr : *found;
}

}  // namespace vismap
