#include "sensor_replay/replay.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <vismap/frame_commit_t.hpp>

#include "base/format.h"
#include "base/reason_counts.h"
#include "rectify/rectifier.h"
#include "runtime/clock.h"
#include "runtime/frame_lag.h"
#include "runtime/peers.h"
#include "runtime/progress.h"
#include "sensor_replay/later_times.h"
#include "sensor_replay/lockstep_window.h"
#include "sensor_replay/map_contents.h"
#include "wire/camera_sources.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

constexpr size_t kMaxSent = 100'000;
constexpr int64_t kLongestRound = int64_t{1}
                                  << 60;  // bounds the shift of utimes, against overflow [us]

/// The frames of a sequence, played once or in a loop. In later rounds the utimes are shifted, so
/// that they keep increasing. Frames that cannot be read are left out.
class Frames {
 public:
  Frames(const Dataset& dataset, bool loop) : dataset_(dataset), loop_(loop) {
    const size_t size = dataset.size();
    int64_t first = dataset.Header(0).utime, last = first;
    for (size_t i = 1; i < size; ++i) {
      first = std::min(first, dataset.Header(i).utime);
      last = std::max(last, dataset.Header(i).utime);
    }
    const int64_t span = std::min(last - first, kLongestRound);
    round_us_ = size > 1 ? span + span / static_cast<int64_t>(size - 1) : 33333;
  }

  /// Moves all utimes [us].
  void MoveTimes(int64_t by) { moved_ = by; }
  const Dataset& dataset() const { return dataset_; }

  bool Has(size_t i) const {
    return (loop_ && left_out_.size() < dataset_.size()) || i < dataset_.size();
  }
  int64_t utime(size_t i) const { return dataset_.Header(i % dataset_.size()).utime + Shift(i); }
  FrameKey key(size_t i) const {
    return {dataset_.Header(i % dataset_.size()).camera_id, utime(i)};
  }

  /// The previous frame of the same camera that can be used; nullopt for the first one.
  std::optional<FrameKey> Predecessor(size_t i) const {
    const CameraId camera = key(i).camera_id;
    while (i-- > 0) {
      if (key(i).camera_id == camera && !IsLeftOut(i)) return key(i);
    }
    return std::nullopt;
  }

  void LeaveOut(size_t i, const std::string& reason) {
    if (left_out_.insert(i % dataset_.size()).second) reasons_.Add(reason);
  }
  bool IsLeftOut(size_t i) const { return left_out_.contains(i % dataset_.size()); }
  /// Also those that the sequence has left out.
  ReasonCounts LeftOut() const {
    ReasonCounts all = reasons_;
    for (const SkippedFrame& skipped : dataset_.skipped()) all.Add(skipped.reason);
    return all;
  }
  int64_t size() const { return static_cast<int64_t>(dataset_.size() + dataset_.skipped().size()); }

  Result<rgbd_frame_t> Message(size_t i) {
    Result<SensorFrame> frame = dataset_.Read(i % dataset_.size());
    if (!frame) return tl::unexpected(frame.error());
    // Check the images: in lockstep, the commit of a frame that cannot be decoded would never
    // arrive.
    if (const Result<RgbdFrame> decoded = rectifier_.Decode(*frame); !decoded)
      return tl::unexpected(decoded.error());
    frame->header.utime += Shift(i);
    return Encode(*frame);
  }

 private:
  int64_t Shift(size_t i) const {
    return moved_ + static_cast<int64_t>(i / dataset_.size()) * round_us_;
  }

  const Dataset& dataset_;
  bool loop_;
  Rectifier rectifier_;
  int64_t round_us_ = 0, moved_ = 0;  // [us]
  std::set<size_t> left_out_;         // frames of the sequence
  ReasonCounts reasons_;
};

/// Replays a sequence, in lockstep or in real time.
class Player {
 public:
  Player(const Dataset& dataset, const SensorReplayOptions& options, const ReplayBounds& bounds,
         ProcessContext* context)
      : frames_(dataset, bounds.loop),
        options_(options),
        wait_for_(bounds.wait_for),
        bus_(*context->bus),
        status_(*context->status),
        peers_(context->bus),
        contents_(context->bus, &peers_),
        newest_times_(context->status),
        progress_("frames of " + dataset.name(),
                  bounds.loop ? 0 : static_cast<int64_t>(dataset.size())) {
    status_.SetCounter("frames_in_sequence", static_cast<int64_t>(dataset.size()));
  }

  Outcome Play() {
    if (!WaitForPeers()) return ExitWith(ExitCode::kFailed, "stopped before the first frame");
    if (!frames_.dataset().has_clock()) GoOnAfterTheMap();
    status_.Set(ProcessState::kRunning);
    TellLeftOut();
    started_ = MonotonicSeconds();
    Outcome outcome = options_.lockstep ? PlayInLockstep() : PlayInRealTime();
    Summarize();
    if (outcome && Unsent() > 0) return ExitWith(ExitCode::kFailed, UnsentText());
    if (const auto shared = SharedCamera(); outcome && shared)
      return ExitWith(ExitCode::kFailed, *shared);
    if (outcome && status_.counter("frames_sent") == 0 && !bus_.stop_requested()) {
      return ExitWith(
          ExitCode::kUnreadable,
          frames_.dataset().name() + ": " + NoUsableFramesText(frames_.LeftOut(), frames_.size()));
    }
    return outcome;
  }

 private:
  bool WaitForPeers() {
    status_.Set(ProcessState::kReady);
    return bus_.Run([this] {
      const std::vector<std::string> missing = peers_.NotReady(wait_for_);
      if (!missing.empty()) {
        if (status_.state() != ProcessState::kWaiting) LogInfo("waiting for " + Join(missing));
        status_.Set(ProcessState::kWaiting, "waiting for " + Join(missing));
      }
      return missing.empty();
    });
  }

  // Without a clock, the frames of two sequences have the same times, and those of the second one
  // would count as already in the map.
  void GoOnAfterTheMap() {
    constexpr double kPatience = 1.5;  // there may be no map server [s]
    const double deadline = MonotonicSeconds() + kPatience;
    bool answered = false;
    bus_.Run([&] {
      contents_.Request();
      answered = contents_.ConsumeAnswer();
      return answered || MonotonicSeconds() > deadline;
    });
    if (!answered) return;
    const int64_t by = LaterTimes(frames_.dataset(), contents_.frames());
    if (by == 0) return;
    frames_.MoveTimes(by);
    LogInfo("the sequence has no clock, and the map has frames of " + ToText(frames_.key(0)) +
            " or before, so its utimes are moved by " +
            FormatDuration(static_cast<double>(by) * 1e-6));
  }

  void TellLeftOut() {
    const ReasonCounts left_out = frames_.LeftOut();
    status_.SetCounter("frames_skipped", left_out.total());
    if (left_out.total() > 0) status_.SetFinding("left out", LeftOutText(left_out, frames_.size()));
  }

  // What the segmenter says when another process publishes frames of the same camera.
  std::optional<std::string> SharedCamera() const {
    for (const auto& [name, peer] : peers_.all()) {
      if (peer.process != "depth-segmenter") continue;
      for (const std::string& finding : peer.findings) {
        if (IsAboutSharedCamera(finding, bus_.source())) return finding;
      }
    }
    return std::nullopt;
  }

  // In lockstep, a frame that could not be sent is sent again.
  int64_t Unsent() const { return options_.lockstep ? 0 : status_.counter("frames_unsent"); }
  std::string UnsentText() const {
    return FormatCount(Unsent(), "frame") + " of " +
           FormatCount(Unsent() + status_.counter("frames_sent")) +
           " could not be sent, since there was no connection to the hub at " + bus_.url();
  }

  // Publishes a frame, or leaves it out when it cannot be read. Returns whether it was published.
  bool Send(size_t i, int64_t after_utime) {
    Result<rgbd_frame_t> message = frames_.Message(i);
    if (!message) {
      LogWarningRateLimited("left out", "a frame is left out: " + message.error().message);
      frames_.LeaveOut(i, message.error().message);
      TellLeftOut();
      return false;
    }
    message->after_utime = after_utime;
    newest_times_.Saw(KeyOf(*message));
    const bool sent = bus_.Publish(kRgbdFrameChannel, std::move(*message));
    status_.Count(sent ? "frames_sent" : "frames_unsent");
    return true;
  }

  Outcome PlayInRealTime() {
    bus_.Subscribe<frame_commit_t>(kMapCommitChannel, [this](const frame_commit_t& commit) {
      if (sent_.erase(KeyOf(commit)) == 0) return;
      status_.Count("frames_committed");
      if (commit.status == frame_commit_t::STATUS_SKIPPED) status_.Count("frames_not_integrated");
    });
    for (size_t i = 0; frames_.Has(i); ++i) {
      const double due = options_.speed > 0
                             ? started_ + static_cast<double>(frames_.utime(i) - frames_.utime(0)) *
                                              1e-6 / options_.speed
                             : 0;
      while (!bus_.stop_requested() &&
             (bus_.Spin(std::max(0.0, due - MonotonicSeconds())), MonotonicSeconds() < due)) {
      }
      if (bus_.stop_requested()) return {};
      if (due > 0) worst_delay_ = std::max(worst_delay_, MonotonicSeconds() - due);
      if (!frames_.IsLeftOut(i) && Send(i, -1) && sent_.size() < kMaxSent)
        sent_.insert(frames_.key(i));
      progress_.Show(static_cast<int64_t>(i) + 1);
    }
    return {};
  }

  // Always names the predecessor: a map server that continues an older map after a crash then holds
  // the frame until the missing ones before it have been sent again.
  bool SendInOrder(size_t i) {
    const std::optional<FrameKey> predecessor = frames_.Predecessor(i);
    return Send(i, predecessor ? predecessor->utime : -1);
  }

  void OnCommit(const frame_commit_t& commit, LockstepWindow* window) {
    if (!window->Commit(KeyOf(commit), MonotonicSeconds())) return;
    status_.Count("frames_committed");
    if (commit.status == frame_commit_t::STATUS_DUPLICATE && !resent_.contains(KeyOf(commit))) {
      status_.Count("frames_in_map_before");
      status_.SetFinding("duplicates",
                         FormatCount(status_.counter("frames_in_map_before"), "frame") +
                             " were left out since the map has frames of their camera and utime "
                             "already, such as " +
                             ToText(KeyOf(commit)));
    }
    if (commit.status == frame_commit_t::STATUS_SKIPPED) {
      status_.Count("frames_not_integrated");
      LogWarningRateLimited("skipped", "the map server skipped the frame of " +
                                           ToText(KeyOf(commit)) + ": " + commit.reason);
    }
  }

  // A restarted map server may lack committed frames. In this case, continues with the first
  // missing frame.
  void RewindIfFramesAreMissing(LockstepWindow* window, size_t* next) {
    if (contents_.ServerRestarted() || window->Stalled(MonotonicSeconds()) || contents_.requested())
      contents_.Request();
    if (!contents_.ConsumeAnswer()) return;
    size_t first = 0;
    while (first < *next && (frames_.IsLeftOut(first) || contents_.Holds(frames_.key(first)) ||
                             window->IsInFlight(frames_.key(first))))
      ++first;
    if (first == *next) return;  // the map has all sent frames
    LogInfo("the map server lost frames and now has " +
            FormatCount(static_cast<int64_t>(contents_.size())) + "; sending again from frame " +
            std::to_string(first) + " instead of frame " + std::to_string(*next));
    status_.Count("frames_rewound", static_cast<int64_t>(*next - first));
    status_.SetCounter("frames_committed", static_cast<int64_t>(first));
    window->Clear();
    for (size_t i = first; i < *next; ++i) resent_.insert(frames_.key(i));
    *next = first;
  }

  // One round: sends new frames until the window is full, repeats overdue frames, then waits for
  // commits.
  void Step(LockstepWindow* window, size_t* next) {
    RewindIfFramesAreMissing(window, next);
    while (frames_.Has(*next) && window->MaySend(frames_.key(*next)) && bus_.connected()) {
      const size_t i = (*next)++;
      if (frames_.IsLeftOut(i) || !SendInOrder(i)) continue;
      window->Sent(i, frames_.key(i), MonotonicSeconds());
      bus_.Spin(0);
    }
    while (const std::optional<size_t> again = window->NextResend(MonotonicSeconds())) {
      resent_.insert(frames_.key(*again));
      SendInOrder(*again);
      status_.Count("frames_resent");
      LogInfo("no commit arrived for " + FormatDuration(options_.resend_s) + ", so frame " +
              std::to_string(*again) + " was sent again");
    }
    bus_.Spin(0.05);
  }

  Outcome PlayInLockstep() {
    auto window = std::make_shared<LockstepWindow>(options_.window_frames, options_.resend_s);
    bus_.Subscribe<frame_commit_t>(kMapCommitChannel, [this, window](const frame_commit_t& commit) {
      OnCommit(commit, window.get());
    });
    size_t next = 0;
    while (frames_.Has(next) || !window->empty()) {
      if (bus_.stop_requested()) {
        return ExitWith(ExitCode::kFailed,
                        "stopped before " +
                            FormatCount(static_cast<int64_t>(window->in_flight()), "sent frame") +
                            " had been committed");
      }
      Step(window.get(), &next);
      ShowState(*window);
    }
    return {};
  }

  void ShowState(const LockstepWindow& window) {
    progress_.Show(status_.counter("frames_committed"));
    const bool waits = !window.HasRoom() || !bus_.connected();
    status_.Set(ProcessState::kRunning, !bus_.connected()
                                            ? "no connection to the hub"
                                            : (waits ? "waiting for MAP_COMMIT" : ""));
  }

  void Summarize() {
    const double seconds = MonotonicSeconds() - started_;
    const auto sent = status_.counter("frames_sent") - status_.counter("frames_resent");
    char rate[32];
    std::snprintf(rate, sizeof(rate), "%.1f", static_cast<double>(sent) / std::max(seconds, 1e-9));
    const int64_t skipped = status_.counter("frames_not_integrated");
    const int64_t before = status_.counter("frames_in_map_before");
    const ReasonCounts left_out = frames_.LeftOut();
    if (left_out.total() > 0) LogWarning(LeftOutText(left_out, frames_.size()));
    if (!options_.lockstep && bus_.reconnects() > 0) {
      LogWarning("the connection to the hub was lost " + FormatCount(bus_.reconnects(), "time") +
                 "; frames that were sent shortly before may be lost");
    }
    LogInfo("sent " + FormatCount(sent, "frame") + " in " + FormatDuration(seconds) + " (" + rate +
            " per second)" +
            (options_.lockstep
                 ? " with " + FormatCount(status_.counter("frames_resent"), "repetition") +
                       "; the map server integrated " +
                       FormatCount(status_.counter("frames_committed") - skipped - before) +
                       ", skipped " + FormatCount(skipped) + " and had " + FormatCount(before) +
                       " before"
                 : ", at most " + FormatDuration(worst_delay_) +
                       " late; so far the map server integrated " +
                       FormatCount(status_.counter("frames_committed") - skipped) +
                       " and skipped " + FormatCount(skipped)));
  }

  Frames frames_;
  const SensorReplayOptions& options_;
  const std::vector<std::string>& wait_for_;
  Bus& bus_;
  Status& status_;
  Peers peers_;
  MapContents contents_;
  NewestTimes newest_times_;
  std::set<FrameKey> sent_;  // in real time: frames without a commit, at most kMaxSent
  Progress progress_;
  std::set<FrameKey> resent_;
  double started_ = 0;
  double worst_delay_ = 0;
};

}  // namespace

Outcome Replay(const Dataset& dataset, const SensorReplayOptions& options,
               const ReplayBounds& bounds, ProcessContext& context) {
  if (dataset.size() == 0)
    return ExitWith(ExitCode::kUnreadable, dataset.name() + ": the sequence has no usable frame");
  return Player(dataset, options, bounds, &context).Play();
}

}  // namespace vismap
