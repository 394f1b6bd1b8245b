#include "depth_segmenter/segmenter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/format.h"
#include "codecs/frame_codec.h"
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

/// Whether two messages are the same frame: same key, image size, depth unit, pose and colour.
/// Depth, source and sequence number are not compared.
bool SameButDepth(const rgbd_frame_t& a, const rgbd_frame_t& b) {
  return KeyOf(a) == KeyOf(b) && a.width == b.width && a.height == b.height &&
         a.depth_unit_m == b.depth_unit_m &&
         std::equal(std::begin(a.T_W_C), std::end(a.T_W_C), std::begin(b.T_W_C)) &&
         a.color == b.color;
}

/// The message of a frame with depth 0 at the pixels that were left out (NaN in `kept`).
rgbd_frame_t WithoutLeftOut(const rgbd_frame_t& message, SensorFrame sensor,
                            const Image<float>& kept) {
  bool changed = false;
  for (size_t i = 0; i < kept.size(); ++i) {
    uint16_t& depth = sensor.depth.data()[i];
    if (!std::isnan(kept.data()[i]) || depth == 0 || depth == 65535) continue;
    depth = 0;
    changed = true;
  }
  rgbd_frame_t result = message;
  if (!changed) return result;
  result.depth = Encode(sensor).depth;
  result.depth_size = static_cast<int32_t>(result.depth.size());
  return result;
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
  const auto answer = std::find_if(answers_.begin(), answers_.end(), [&](const Answer& a) {
    return a.depth == message.depth && SameButDepth(a.message.frame, message);
  });
  if (answer == answers_.end()) return false;  // a new frame, or its result is no longer stored
  // Copy the new message, because its after_utime may have changed, but keep the depth of the
  // result.
  rgbd_frame_t& frame = answer->message.frame;
  std::vector<uint8_t> depth = std::move(frame.depth);
  frame = message;
  frame.depth = std::move(depth);
  frame.depth_size = static_cast<int32_t>(frame.depth.size());
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
  while (std::optional<JoinedFrame> joined = join_.Next(MonotonicSeconds(), Patience()))
    ready_.push_back(std::move(*joined));
  while (options_.overload == Overload::kNewest && ready_.size() > kNewestKept) {
    ready_.pop_front();
    ++dropped_behind_;
  }
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
  Remember(joined.frame.depth, std::move(*answer));
  return true;
}

void Segmenter::LeaveOut(const std::string& reason) {
  left_out_.Add(reason);
  status_.SetFinding("left out",
                     LeftOutText(left_out_, status_.counter("frames") + left_out_.total()));
}

// Logs the intrinsics of a new camera, and which process publishes them.
void Segmenter::CheckSource(const FrameHeader& header, const rgbd_frame_t& message) {
  const std::string subject = "sources of camera " + std::to_string(Raw(header.camera_id));
  if (const auto shared =
          sources_.Add(header.camera_id, message.source, message.seq, MonotonicSeconds()))
    status_.SetFinding(subject, shared);
}

void Segmenter::TellCamera(const FrameHeader& header, const std::string& source) {
  if (cameras_.size() >= kMaxCameras || !cameras_.insert(header.camera_id).second) return;
  LogInfo("camera " + std::to_string(Raw(header.camera_id)) + ": " + CameraText(header.camera) +
          ": from the RGBD_FRAMEs of " + source);
}

void Segmenter::Remember(const std::vector<uint8_t>& depth, segmented_frame_t message) {
  const size_t bytes = depth.size() + BytesOf(message);
  answer_bytes_ += bytes;
  answers_.push_back({depth, std::move(message), bytes, MonotonicSeconds()});
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
  const Result<SensorFrame> sensor = Decode(joined.frame);
  if (!sensor) return tl::unexpected(sensor.error());
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
    if (message.image_width == joined.frame.width && message.image_height == joined.frame.height) {
      detections = *Decode(message);
    } else {
      status_.Count("detections_of_other_size");
      LogWarningRateLimited(
          "size",
          "DETECTIONS of " + ToText(KeyOf(message)) + " are for images of " +
              std::to_string(message.image_width) + "x" + std::to_string(message.image_height) +
              ", but the frame has " + std::to_string(joined.frame.width) + "x" +
              std::to_string(joined.frame.height) + "; the frame is segmented without them");
    }
  }
  status_.Count("frames_with_detections", detections ? 1 : 0);
  rgbd_frame_t message = joined.frame;
  if (detections && vismap::LeaveOut(*detections, stage_.refine, &*frame) > 0)
    message = WithoutLeftOut(joined.frame, *sensor, frame->depth);
  const SegmentedFrame segmented =
      SegmentFrame(std::move(*frame), detections ? &*detections : nullptr, stage_);
  CheckSegments(segmented);
  return Encode(segmented, message);
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
