#include "sensor_replay/replay.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <vismap/frame_commit_t.hpp>

#include "base/format.h"
#include "codecs/frame_codec.h"
#include "runtime/clock.h"
#include "runtime/peers.h"
#include "runtime/progress.h"
#include "sensor_replay/lockstep_window.h"
#include "sensor_replay/map_contents.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

constexpr int64_t kLongestRound = int64_t{1}
                                  << 60;  // bounds the shift of utimes, against overflow [us]

/// The frames of a sequence, played once or in a loop. In later rounds the utimes are shifted, so
/// that they keep increasing.
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

  bool Has(size_t i) const { return loop_ || i < dataset_.size(); }
  int64_t utime(size_t i) const { return dataset_.Header(i % dataset_.size()).utime + Shift(i); }
  FrameKey key(size_t i) const {
    return {dataset_.Header(i % dataset_.size()).camera_id, utime(i)};
  }

  /// The previous frame of the same camera; nullopt for the first one.
  std::optional<FrameKey> Predecessor(size_t i) const {
    const CameraId camera = key(i).camera_id;
    while (i-- > 0) {
      if (key(i).camera_id == camera) return key(i);
    }
    return std::nullopt;
  }

  Result<rgbd_frame_t> Message(size_t i) const {
    Result<SensorFrame> frame = dataset_.Read(i % dataset_.size());
    if (!frame) return tl::unexpected(frame.error());
    // Check the images: in lockstep, the commit of a frame that cannot be decoded would never
    // arrive.
    if (const Result<RgbdFrame> decoded = DecodeFrame(*frame); !decoded) {
      return Fail(dataset_.name() + ", frame " + std::to_string(frame->header.frame_number) + ": " +
                  decoded.error().message);
    }
    frame->header.utime += Shift(i);
    return Encode(*frame);
  }

 private:
  int64_t Shift(size_t i) const { return static_cast<int64_t>(i / dataset_.size()) * round_us_; }

  const Dataset& dataset_;
  bool loop_;
  int64_t round_us_ = 0;
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
        progress_("frames of " + dataset.name(),
                  bounds.loop ? 0 : static_cast<int64_t>(dataset.size())) {
    status_.SetCounter("frames_in_sequence", static_cast<int64_t>(dataset.size()));
    status_.SetCounter("frames_skipped", static_cast<int64_t>(dataset.skipped().size()));
  }

  Outcome Play() {
    if (!WaitForPeers()) return ExitWith(ExitCode::kFailed, "stopped before the first frame");
    status_.Set(ProcessState::kRunning);
    started_ = MonotonicSeconds();
    Outcome outcome = options_.lockstep ? PlayInLockstep() : PlayInRealTime();
    Summarize();
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

  Outcome Send(size_t i, int64_t after_utime) {
    Result<rgbd_frame_t> message = frames_.Message(i);
    if (!message) return ExitWith(ExitCode::kUnreadable, message.error().message);
    message->after_utime = after_utime;
    bus_.Publish(kRgbdFrameChannel, std::move(*message));
    status_.Count("frames_sent");
    return {};
  }

  Outcome PlayInRealTime() {
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
      if (const Outcome sent = Send(i, -1); !sent) return sent;
      progress_.Show(static_cast<int64_t>(i) + 1);
    }
    return {};
  }

  // Always names the predecessor: a map server that continues an older map after a crash then holds
  // the frame until the missing ones before it have been sent again.
  Outcome SendInOrder(size_t i) {
    const std::optional<FrameKey> predecessor = frames_.Predecessor(i);
    return Send(i, predecessor ? predecessor->utime : -1);
  }

  void OnCommit(const frame_commit_t& commit, LockstepWindow* window) {
    if (!window->Commit(KeyOf(commit), MonotonicSeconds())) return;
    status_.Count("frames_committed");
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
    while (first < *next &&
           (contents_.Holds(frames_.key(first)) || window->IsInFlight(frames_.key(first))))
      ++first;
    if (first == *next) return;  // the map has all sent frames
    LogInfo("the map server lost frames and now has " +
            FormatCount(static_cast<int64_t>(contents_.size())) + "; sending again from frame " +
            std::to_string(first) + " instead of frame " + std::to_string(*next));
    status_.Count("frames_rewound", static_cast<int64_t>(*next - first));
    status_.SetCounter("frames_committed", static_cast<int64_t>(first));
    window->Clear();
    *next = first;
  }

  // One round: sends new frames until the window is full, repeats overdue frames, then waits for
  // commits.
  Outcome Step(LockstepWindow* window, size_t* next) {
    RewindIfFramesAreMissing(window, next);
    while (frames_.Has(*next) && window->MaySend(frames_.key(*next)) && bus_.connected()) {
      window->Sent(*next, frames_.key(*next), MonotonicSeconds());
      if (const Outcome sent = SendInOrder(*next); !sent) return sent;
      ++*next;
      bus_.Spin(0);
    }
    while (const std::optional<size_t> again = window->NextResend(MonotonicSeconds())) {
      if (const Outcome sent = SendInOrder(*again); !sent) return sent;
      status_.Count("frames_resent");
      LogInfo("no commit arrived for " + FormatDuration(options_.resend_s) + ", so frame " +
              std::to_string(*again) + " was sent again");
    }
    bus_.Spin(0.05);
    return {};
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
      if (const Outcome stepped = Step(window.get(), &next); !stepped) return stepped;
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
    LogInfo("sent " + FormatCount(sent, "frame") + " in " + FormatDuration(seconds) + " (" + rate +
            " per second)" +
            (options_.lockstep
                 ? " with " + FormatCount(status_.counter("frames_resent"), "repetition") +
                       "; the map server integrated " +
                       FormatCount(status_.counter("frames_committed") - skipped) +
                       " and skipped " + FormatCount(skipped)
                 : ", at most " + FormatDuration(worst_delay_) + " late"));
  }

  Frames frames_;
  const SensorReplayOptions& options_;
  const std::vector<std::string>& wait_for_;
  Bus& bus_;
  Status& status_;
  Peers peers_;
  MapContents contents_;
  Progress progress_;
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
