#include "detector/live_detector.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "base/digest.h"
#include "base/format.h"
#include "runtime/clock.h"
#include "wire/detections.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

constexpr double kPacePeriod = 10;  // time between two log lines on the pace [s]
// Longest wait for messages, while the network runs and while it does not [s].
constexpr double kWhileWorking = 0.002, kWhileIdle = 0.1;
constexpr size_t kMaxAnswers = 32;  // results kept for frames that are sent again

/// Decodes the colour of a frame and runs the network on it.
Result<DetectionSet> RunDetector(const rgbd_frame_t& message, Rectifier* rectifier,
                                 DnnDetector* detector) {
  const Result<SensorFrame> frame = DecodeWithoutDepth(message);
  if (!frame) return tl::unexpected(frame.error());
  const Result<Image<Rgb8>> color = rectifier->DecodeColor(*frame);
  if (!color) return tl::unexpected(color.error());
  return detector->Detect(*color, frame->header);
}

}  // namespace

LiveDetector::LiveDetector(const DetectorOptions& options, DnnDetector* detector,
                           ProcessContext* context)
    : options_(options),
      detector_(*detector),
      bus_(*context->bus),
      status_(*context->status),
      pace_(MonotonicSeconds()) {
  bus_.Subscribe<rgbd_frame_t>(kRgbdFrameChannel,
                               [this](const rgbd_frame_t& message) { return OnFrame(message); });
  bus_.Every(kPacePeriod, [this] { LogPace(); });
}

void LiveDetector::Run() {
  status_.Set(ProcessState::kReady);
  while (!bus_.stop_requested()) {
    bus_.Spin(work_ ? kWhileWorking : kWhileIdle);
    PublishIfReady(0);
    // Spin has handled all messages that had arrived, so this is the newest frame.
    if (work_) continue;
    if (const std::optional<rgbd_frame_t> next = waiting_.Next()) StartDetection(*next);
  }
  PublishIfReady(60);
  LogPace();
  LogInfo("found " + FormatCount(status_.counter("detections"), "detection") + " in " +
          FormatCount(status_.counter("frames"), "frame") + "; skipped " +
          FormatCount(status_.counter("frames_skipped"), "frame"));
}

Result<void> LiveDetector::OnFrame(const rgbd_frame_t& message) {
  if (options_.camera_id >= 0 && message.camera_id != options_.camera_id) return {};
  const Result<FrameHeader> header = DecodeHeader(message);
  if (!header) return tl::unexpected(header.error());
  status_.Set(ProcessState::kRunning);
  if (RepeatAnswer(message)) return {};
  if (!options_.every_frame) {
    Enqueue(message);
    return {};
  }
  const double start = MonotonicSeconds();
  const DetectionResult result = RunDetector(message, &rectifier_, &detector_);
  pace_.AddProcessed((MonotonicSeconds() - start) * 1e3);
  status_.AddTiming("detection", (MonotonicSeconds() - start) * 1e3);
  PublishResult(message, *header, result);
  return {};
}

void LiveDetector::Enqueue(const rgbd_frame_t& message) {
  const FrameKey key = KeyOf(message);
  if (waiting_.Waits(key) || (work_ && KeyOf(work_->frame) == key)) {
    status_.Count("frames_repeated");  // its result will be published later
    return;
  }
  const std::optional<rgbd_frame_t> older = waiting_.Add(message);
  if (!older) return;  // no frame is skipped
  pace_.AddSkipped();
  status_.Count("frames_skipped");
  if (const auto header = DecodeHeader(*older))
    bus_.Publish(kDetectionsChannel, EncodeDetectorDidNotRun(*header));
}

void LiveDetector::StartDetection(const rgbd_frame_t& message) {
  const Result<FrameHeader> header = DecodeHeader(message);
  if (!header) return;  // cannot happen, OnFrame has decoded it
  work_.emplace(Work{message, *header, MonotonicSeconds(), {}});
  work_->result = std::async(std::launch::async, [this, work = &*work_] {
    return RunDetector(work->frame, &rectifier_, &detector_);
  });
}

void LiveDetector::PublishIfReady(double timeout) {
  if (!work_ ||
      work_->result.wait_for(std::chrono::duration<double>(timeout)) != std::future_status::ready)
    return;
  const DetectionResult result = work_->result.get();
  const double ms = (MonotonicSeconds() - work_->start) * 1e3;
  pace_.AddProcessed(ms);
  status_.AddTiming("detection", ms);
  PublishResult(work_->frame, work_->header, result);
  work_.reset();
}

void LiveDetector::PublishResult(const rgbd_frame_t& frame, const FrameHeader& header,
                                 const DetectionResult& result) {
  if (!result) {
    status_.Count("frames_unusable");
    LogWarningRateLimited("unusable", "RGBD_FRAME of " + ToText(KeyOf(frame)) +
                                          " gets no detections: " + result.error().message);
    bus_.Publish(kDetectionsChannel, EncodeDetectorDidNotRun(header));
    return;
  }
  detections_t message = Encode(*result, header.camera.width, header.camera.height);
  bus_.Publish(kDetectionsChannel, message);
  status_.Count("frames");
  status_.Count("detections", static_cast<int64_t>(result->detections.size()));
  answers_.push_back({KeyOf(frame), Checksum64(frame.color), std::move(message)});
  if (answers_.size() > kMaxAnswers) answers_.pop_front();
}

bool LiveDetector::RepeatAnswer(const rgbd_frame_t& message) {
  const FrameKey key = KeyOf(message);
  const auto known = std::find_if(answers_.begin(), answers_.end(), [&](const Answer& answer) {
    return answer.key == key && answer.color == Checksum64(message.color);
  });
  if (known == answers_.end()) return false;
  status_.Count("frames_answered_again");
  bus_.Publish(kDetectionsChannel, known->message);
  return true;
}

void LiveDetector::LogPace() {
  if (const std::optional<std::string> sentence = pace_.Summarize(MonotonicSeconds()))
    LogInfo(*sentence);
}

}  // namespace vismap
