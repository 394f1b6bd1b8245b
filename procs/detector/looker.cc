#include "detector/looker.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "base/digest.h"
#include "codecs/color_codec.h"
#include "runtime/clock.h"
#include "wire/detections.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

constexpr double kPacePeriod = 10;       // between two log lines [s]
constexpr double kWhileWorking = 0.002;  // how often it is seen whether the network is done [s]
constexpr double kWhileIdle = 0.1;       // [s]
constexpr size_t kMaxAnswers = 32;       // kept for frames that are sent again

/// Decodes the colour of a frame and looks at it.
Result<DetectionSet> LookAt(const rgbd_frame_t& message, const FrameHeader& header,
                            DnnDetector* detector) {
  if (message.color_encoding != rgbd_frame_t::COLOR_JPEG) return Fail("the frame has no colour");
  const Result<Image<Rgb8>> color =
      DecodeJpeg(message.color, header.camera.width, header.camera.height);
  if (!color) return tl::unexpected(color.error());
  return detector->Detect(*color, header);
}

}  // namespace

Looker::Looker(const DetectorOptions& options, DnnDetector* detector, ProcessContext* context)
    : options_(options),
      detector_(*detector),
      bus_(*context->bus),
      status_(*context->status),
      pace_(MonotonicSeconds()) {
  bus_.Subscribe<rgbd_frame_t>(kRgbdFrameChannel,
                               [this](const rgbd_frame_t& message) { return OnFrame(message); });
  bus_.Every(kPacePeriod, [this] { TellPace(); });
}

void Looker::Run() {
  status_.Set(ProcessState::kReady);
  while (!bus_.stop_requested()) {
    bus_.Spin(work_ ? kWhileWorking : kWhileIdle);
    FinishIfDone(0);
    // Spin has taken everything that had arrived, so this is the newest frame.
    if (work_) continue;
    if (const std::optional<rgbd_frame_t> next = waiting_.Next()) Start(*next);
  }
  FinishIfDone(60);
  TellPace();
  LogInfo("looked at " + std::to_string(status_.counter("frames")) + " frames, passed over " +
          std::to_string(status_.counter("frames_passed_over")) + ", found " +
          std::to_string(status_.counter("detections")) + " detections");
}

Result<void> Looker::OnFrame(const rgbd_frame_t& message) {
  if (options_.camera_id >= 0 && message.camera_id != options_.camera_id) return {};
  const Result<FrameHeader> header = DecodeHeader(message);
  if (!header) return tl::unexpected(header.error());
  status_.Set(ProcessState::kRunning);
  if (AnswerAgain(message)) return {};
  if (!options_.every_frame) {
    Offer(message);
    return {};
  }
  const double start = MonotonicSeconds();
  const Sets seen = LookAt(message, *header, &detector_);
  pace_.Looked((MonotonicSeconds() - start) * 1e3);
  status_.AddTiming("detection", (MonotonicSeconds() - start) * 1e3);
  Say(message, *header, seen);
  return {};
}

void Looker::Offer(const rgbd_frame_t& message) {
  const FrameKey key = KeyOf(message);
  if (waiting_.Waits(key) || (work_ && KeyOf(work_->frame) == key)) {
    status_.Count("frames_repeated");  // its one answer is still to come
    return;
  }
  const std::optional<rgbd_frame_t> older = waiting_.Add(message);
  if (!older) return;
  pace_.PassedOver();
  status_.Count("frames_passed_over");
  if (const auto header = DecodeHeader(*older))
    bus_.Publish(kDetectionsChannel, EncodeNotLooked(*header));
}

void Looker::Start(const rgbd_frame_t& message) {
  const Result<FrameHeader> header = DecodeHeader(message);
  if (!header) return;  // was seen to be good when it arrived
  work_.emplace(Work{message, *header, MonotonicSeconds(), {}});
  work_->result = std::async(std::launch::async, [work = &*work_, detector = &detector_] {
    return LookAt(work->frame, work->header, detector);
  });
}

void Looker::FinishIfDone(double patience) {
  if (!work_ ||
      work_->result.wait_for(std::chrono::duration<double>(patience)) != std::future_status::ready)
    return;
  const Sets seen = work_->result.get();
  const double ms = (MonotonicSeconds() - work_->start) * 1e3;
  pace_.Looked(ms);
  status_.AddTiming("detection", ms);
  Say(work_->frame, work_->header, seen);
  work_.reset();
}

void Looker::Say(const rgbd_frame_t& frame, const FrameHeader& header, const Sets& seen) {
  if (!seen) {
    status_.Count("frames_unusable");
    LogWarningSometimes("unusable", "RGBD_FRAME of " + ToText(KeyOf(frame)) +
                                        " goes on without detections: " + seen.error().message);
    bus_.Publish(kDetectionsChannel, EncodeNotLooked(header));
    return;
  }
  detections_t message = Encode(*seen, header.camera.width, header.camera.height);
  bus_.Publish(kDetectionsChannel, message);
  status_.Count("frames");
  status_.Count("detections", static_cast<int64_t>(seen->detections.size()));
  answers_.push_back({KeyOf(frame), Checksum64(frame.color), std::move(message)});
  if (answers_.size() > kMaxAnswers) answers_.pop_front();
}

bool Looker::AnswerAgain(const rgbd_frame_t& message) {
  const FrameKey key = KeyOf(message);
  const auto known = std::find_if(answers_.begin(), answers_.end(), [&](const Answer& answer) {
    return answer.key == key && answer.color == Checksum64(message.color);
  });
  if (known == answers_.end()) return false;
  status_.Count("frames_answered_again");
  bus_.Publish(kDetectionsChannel, known->message);
  return true;
}

void Looker::TellPace() {
  if (const std::optional<std::string> sentence = pace_.Take(MonotonicSeconds()))
    LogInfo(*sentence);
}

}  // namespace vismap
