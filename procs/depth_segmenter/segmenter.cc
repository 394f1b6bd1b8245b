#include "depth_segmenter/segmenter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/digest.h"
#include "base/format.h"
#include "codecs/frame_codec.h"
#include "plausibility/depth_losses.h"
#include "runtime/clock.h"
#include "segmentation/leave_out.h"
#include "segmentation/segment_frame.h"
#include "wire/detections.h"
#include "wire/rgbd_frame.h"
#include "wire/segmented_frame.h"

namespace vismap {
namespace {

constexpr double kPatienceCheck = 0.05;  // time between two checks of the waiting frames [s]
constexpr size_t kNewestKept = 2;        // ready frames that are kept with Overload::kNewest
constexpr double kReportedWait = 0.5;    // a longer wait is shown in the status [s]
constexpr size_t kMaxCameras = 100;      // whose intrinsics are logged
// Results kept for frames that are sent again: so many, of so many bytes, for so long [s].
constexpr size_t kMaxAnswers = 32;
constexpr size_t kMaxAnswerBytes = 64 * kMegabyte;
constexpr double kMaxAnswerAge = 60;

JoinLimits LimitsOf(const DepthSegmenterOptions& options) {
  JoinLimits limits;
  limits.capacity = static_cast<size_t>(options.max_waiting_frames);
  limits.max_bytes = static_cast<size_t>(options.queue_mb) * kMegabyte;
  limits.max_wait_s = options.max_wait_s;
  return limits;
}

size_t BytesOf(const segmented_frame_t& message) {
  return 1024 + message.frame.depth.size() + message.frame.color.size() + message.labels.size() +
         message.segments.size() * sizeof(frame_segment_t);
}

/// Digest of the images of a frame and of its cameras and pose. Source, sequence number and
/// after_utime may differ between copies of a frame.
std::string DigestOf(const rgbd_frame_t& frame) {
  Digest digest;
  const auto add_camera = [&](const camera_t& camera) {
    for (const int32_t number : {camera.width, camera.height, int32_t{camera.distortion}})
      digest.Add(number);
    for (const double number : {camera.fx, camera.fy, camera.cx, camera.cy}) digest.Add(number);
    digest.AddBytes(camera.coefficients.data(), camera.coefficients.size() * sizeof(double));
  };
  add_camera(frame.color_camera);
  add_camera(frame.depth_camera);
  digest.AddBytes(frame.T_W_C, sizeof(frame.T_W_C));
  digest.AddBytes(frame.T_color_depth, sizeof(frame.T_color_depth));
  digest.Add(frame.depth_unit_m);
  for (const int8_t code : {frame.depth_registered, frame.depth_encoding, frame.color_encoding})
    digest.Add(code);
  digest.AddBytes(frame.depth.data(), frame.depth.size());
  digest.AddBytes(frame.color.data(), frame.color.size());
  return digest.Hex();
}

void CopyOrigin(const rgbd_frame_t& from, rgbd_frame_t* to) {
  to->seq = from.seq;
  to->source = from.source;
  to->checksum = from.checksum;
  to->after_utime = from.after_utime;
}

/// The message of a frame that was rectified, or has lost depth that was no measurement.
rgbd_frame_t EncodeAgain(const SensorFrame& sensor, const rgbd_frame_t& original) {
  rgbd_frame_t message = Encode(sensor);
  CopyOrigin(original, &message);
  return message;
}

/// Takes the depth of pixels that were left out (NaN in `kept`) out of `sensor`. Returns whether
/// there are any.
bool RemoveLeftOut(const Image<float>& kept, SensorFrame* sensor) {
  bool changed = false;
  for (size_t i = 0; i < kept.size(); ++i) {
    if (!std::isnan(kept.data()[i])) continue;
    if (sensor->depth.empty()) {
      changed |= !std::isnan(std::exchange(sensor->depth_m.data()[i], kept.data()[i]));
    } else if (uint16_t& depth = sensor->depth.data()[i]; depth != 0 && depth != 65535) {
      depth = 0;
      changed = true;
    }
  }
  return changed;
}

/// The message of a frame without the depth of pixels that were left out (NaN in `kept`).
rgbd_frame_t WithoutLeftOut(rgbd_frame_t message, SensorFrame sensor, const Image<float>& kept) {
  if (!RemoveLeftOut(kept, &sensor)) return message;
  rgbd_frame_t changed = Encode(sensor);
  message.depth_encoding = changed.depth_encoding;
  message.depth = std::move(changed.depth);
  message.depth_size = changed.depth_size;
  return message;
}

}  // namespace

Segmenter::Segmenter(const DepthSegmenterOptions& options, const SegmentationStageOptions& stage,
                     ProcessContext* context)
    : options_(options),
      stage_(stage),
      bus_(*context->bus),
      status_(*context->status),
      peers_(context->bus),
      join_(LimitsOf(options)),
      newest_times_(context->status),
      segment_check_(DepthLimits{stage.surface.min_depth_m, stage.surface.max_depth_m}) {
  bus_.Subscribe<rgbd_frame_t>(kRgbdFrameChannel,
                               [this](const rgbd_frame_t& message) { return OnFrame(message); });
  if (options_.detections != WaitForDetections::kNone) {
    bus_.Subscribe<detections_t>(
        kDetectionsChannel, [this](const detections_t& message) { return OnDetections(message); });
  }
  bus_.Every(kPatienceCheck, [this] { HandleReadyFrames(); });
}

void Segmenter::Run() {
  status_.Set(ProcessState::kReady);
  while (!bus_.stop_requested()) {
    bus_.Spin(ready_.empty() ? 0.1 : 0);
    SegmentNext();  // Spin has received all frames that had arrived
  }
  const int64_t waiting = static_cast<int64_t>(join_.waiting() + ready_.size());
  LogInfo("segmented " + FormatCount(status_.counter("frames"), "frame") + ", " +
          FormatCount(join_.counters().frames_without) + " of them without detections; dropped " +
          FormatCount(status_.counter("frames_dropped")) + ", could not use " +
          FormatCount(status_.counter("frames_unusable")) + ", and " + FormatCount(waiting) +
          (waiting == 1 ? " still waits" : " still wait"));
}

Result<void> Segmenter::OnFrame(const rgbd_frame_t& message) {
  const Result<FrameHeader> header = DecodeHeader(message);
  if (header) CheckSource(*header, message);
  if (RepeatAnswer(message)) return {};
  if (!header) {
    LeaveOut(header.error().message);
    return tl::unexpected(header.error());
  }
  TellCamera(*header, message.source);
  newest_times_.Saw(KeyOf(message));
  join_.AddFrame(message, MonotonicSeconds());
  HandleReadyFrames();
  return {};
}

Result<void> Segmenter::OnDetections(const detections_t& message) {
  if (DetectorRan(message)) {
    if (const Result<DetectionSet> set = Decode(message); !set) return tl::unexpected(set.error());
  }
  join_.AddDetections(message, MonotonicSeconds());
  HandleReadyFrames();
  return {};
}

bool Segmenter::RepeatAnswer(const rgbd_frame_t& message) {
  const FrameKey key = KeyOf(message);
  const auto same_key = [&](const Answer& answer) { return answer.key == key; };
  if (std::none_of(answers_.begin(), answers_.end(), same_key)) return false;
  const std::string digest = DigestOf(message);
  const auto answer = std::find_if(answers_.begin(), answers_.end(), [&](const Answer& a) {
    return same_key(a) && a.digest == digest;
  });
  if (answer == answers_.end()) return false;   // a new frame, or its result is no longer stored
  CopyOrigin(message, &answer->message.frame);  // its after_utime may have changed
  status_.Count("frames_answered_again");
  bus_.Publish(kSegmentedFrameChannel, answer->message);
  return true;
}

double Segmenter::Patience() const {
  switch (options_.detections) {
    case WaitForDetections::kRequired:
      return std::numeric_limits<double>::infinity();
    case WaitForDetections::kAuto:
      return peers_.IsAlive("detector") ? options_.detection_timeout_s : 0;
    case WaitForDetections::kNone:
      break;
  }
  return 0;
}

void Segmenter::HandleReadyFrames() {
  CollectReadyFrames();
  while (options_.overload == Overload::kLossless && SegmentNext()) {
  }
  join_.DropLate(MonotonicSeconds());
  ForgetAnswers();
  UpdateStatus();
}

void Segmenter::CollectReadyFrames() {
  while (std::optional<JoinedFrame> joined = join_.Next(MonotonicSeconds(), Patience())) {
    TellDelay(*joined);
    ready_.push_back(std::move(*joined));
  }
  while (options_.overload == Overload::kNewest && ready_.size() > kNewestKept) {
    ready_.pop_front();
    ++dropped_behind_;
  }
}

// How long after the frames of each camera their detections come.
void Segmenter::TellDelay(const JoinedFrame& joined) {
  const CameraId camera{joined.frame.camera_id};
  if (!joined.detections || !DetectorRan(*joined.detections) || !cameras_.contains(camera)) return;
  status_.AddTiming("detections of camera " + std::to_string(Raw(camera)),
                    joined.detections_after_s * 1e3);
}

// Returns false when no frame is ready.
bool Segmenter::SegmentNext() {
  if (ready_.empty()) return false;
  const JoinedFrame joined = std::move(ready_.front());
  ready_.pop_front();
  Result<segmented_frame_t> answer = Segment(joined);
  if (!answer) {
    status_.Count("frames_unusable");
    LogWarningRateLimited("unusable", "an RGBD_FRAME was rejected: " + answer.error().message);
    LeaveOut(answer.error().message);
    return true;
  }
  status_.Count("frames");
  status_.Count("segments", answer->n_segments);
  bus_.Publish(kSegmentedFrameChannel, *answer);
  Remember(joined.frame, std::move(*answer));
  return true;
}

void Segmenter::LeaveOut(const std::string& reason) {
  left_out_.Add(reason);
  status_.SetFinding("left out",
                     LeftOutText(left_out_, status_.counter("frames") + left_out_.total()));
}

// Tells in STATUS when several processes publish frames of one camera.
void Segmenter::CheckSource(const FrameHeader& header, const rgbd_frame_t& message) {
  const std::string subject = "sources of camera " + std::to_string(Raw(header.camera_id));
  const auto shared =
      sources_.Add(header.camera_id, message.source, message.seq, MonotonicSeconds());
  if (!shared) return;
  status_.SetFinding(subject, shared);
  // At once, so that also a replay that takes less than a second hears of it.
  if (shared_cameras_.insert(header.camera_id).second) status_.Publish();
}

// Logs the intrinsics of a new camera, and which process publishes them.
void Segmenter::TellCamera(const FrameHeader& header, const std::string& source) {
  if (cameras_.size() >= kMaxCameras || !cameras_.insert(header.camera_id).second) return;
  LogInfo("camera " + std::to_string(Raw(header.camera_id)) + ": " + CameraText(header.camera) +
          ": from the RGBD_FRAMEs of " + source);
}

void Segmenter::Remember(const rgbd_frame_t& frame, segmented_frame_t message) {
  const size_t bytes = BytesOf(message);
  answer_bytes_ += bytes;
  answers_.push_back(
      {KeyOf(frame), DigestOf(frame), std::move(message), bytes, MonotonicSeconds()});
}

void Segmenter::ForgetAnswers() {
  while (!answers_.empty() && (answers_.size() > kMaxAnswers || answer_bytes_ > kMaxAnswerBytes ||
                               MonotonicSeconds() - answers_.front().time > kMaxAnswerAge)) {
    answer_bytes_ -= answers_.front().bytes;
    answers_.pop_front();
  }
}

Result<segmented_frame_t> Segmenter::Segment(const JoinedFrame& joined) {
  const StageTimer timer(&status_, "segmentation");
  Result<SensorFrame> sensor = Decode(joined.frame);
  if (!sensor) return tl::unexpected(sensor.error());
  const bool measured = CountLosses(DropSaturatedDepth(stage_.surface, &*sensor));
  const bool ideal = !sensor->optics;
  if (!ideal) {
    const StageTimer rectification(&status_, "rectification");
    sensor = rectifier_.Rectify(std::move(*sensor));
    if (!sensor) return tl::unexpected(sensor.error());
  }
  Result<RgbdFrame> frame = DecodeFrame(*sensor);
  if (!frame) return tl::unexpected(frame.error());
  if (!frame->color_problem.empty()) {
    without_color_.Add(frame->color_problem);
    status_.SetFinding("colour",
                       std::to_string(without_color_.total()) +
                           " frames are mapped without their colour: " + without_color_.Text());
  }
  std::optional<DetectionSet> detections;
  if (joined.detections && DetectorRan(*joined.detections)) {
    const detections_t& message = *joined.detections;
    const PinholeCamera& camera = frame->header.camera;
    if (message.image_width == camera.width && message.image_height == camera.height) {
      detections = *Decode(message);
    } else {
      status_.Count("detections_of_other_size");
      LogWarningRateLimited("size",
                            "DETECTIONS of " + ToText(KeyOf(message)) + " are for images of " +
                                std::to_string(message.image_width) + "x" +
                                std::to_string(message.image_height) + ", but the frame has " +
                                std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                                "; the frame is segmented without them");
    }
  }
  status_.Count("frames_with_detections", detections ? 1 : 0);
  rgbd_frame_t message = ideal && measured ? joined.frame : EncodeAgain(*sensor, joined.frame);
  if (detections && vismap::LeaveOut(*detections, stage_.refine, &*frame) > 0)
    message = WithoutLeftOut(std::move(message), std::move(*sensor), frame->depth);
  const SegmentedFrame segmented =
      SegmentFrame(std::move(*frame), detections ? &*detections : nullptr, stage_);
  CheckSegments(segmented);
  return Encode(segmented, message);
}

// Counts the depth that is no measurement. Returns whether the frame has kept all of its depth.
bool Segmenter::CountLosses(const DepthLosses& losses) {
  constexpr int64_t kStride = 16;
  depth_losses_.Add(losses);
  status_.Count("pixels_saturated", losses.saturated);
  status_.Count("pixels_beyond_limits", losses.too_near + losses.too_far);
  if (depth_losses_.frames % kStride == 1)
    status_.SetFindings("depth", FindingsOf(depth_losses_, stage_.surface));
  return losses.saturated == 0;
}

// Looks at every 4th frame, since that takes time, and forgets what is old.
void Segmenter::CheckSegments(const SegmentedFrame& frame) {
  constexpr int64_t kStride = 4, kFewest = 2, kMost = 64;
  if (status_.counter("frames") % kStride != 0) return;
  segment_check_.Add(frame);
  if (segment_check_.frames() < kFewest) return;
  status_.SetFinding("segments", segment_check_.SegmentFinding());
  if (segment_check_.frames() == kMost)
    segment_check_ = DepthCheck({stage_.surface.min_depth_m, stage_.surface.max_depth_m});
}

void Segmenter::UpdateStatus() {
  const JoinCounters& counters = join_.counters();
  status_.SetCounter("frames_waiting", static_cast<int64_t>(join_.waiting()));
  status_.SetCounter("waiting_bytes", static_cast<int64_t>(join_.bytes()));
  status_.SetCounter("frames_dropped", counters.frames_dropped + dropped_behind_);
  status_.SetCounter("frames_repeated", counters.frames_repeated);
  status_.SetCounter("frames_without_detections", counters.frames_without);
  status_.SetCounter("detections_dropped", counters.detections_dropped);
  status_.SetCounter("detections_late", counters.detections_late);
  status_.SetCounter("detections_repeated", counters.detections_repeated);
  const double waited = join_.Waited(MonotonicSeconds());
  if (waited > kReportedWait) {
    status_.Set(ProcessState::kWaiting,
                "waiting for DETECTIONS: the oldest frame has waited for " +
                    FormatDuration(std::ceil(waited)) +
                    (peers_.IsAlive("detector") ? "" : ", and no detector is on the bus"));
  } else if (status_.counter("frames") > 0) {
    const bool alone =
        options_.detections == WaitForDetections::kAuto && !peers_.IsAlive("detector");
    status_.Set(
        ProcessState::kRunning,
        alone ? "no detector is on the bus, so frames are segmented by geometry alone" : "");
  }
}

}  // namespace vismap
