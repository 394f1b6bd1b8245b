#include "adapter/adapter.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "base/format.h"
#include "foreign/frame_message.h"
#include "foreign/presets.h"
#include "runtime/clock.h"
#include "runtime/log.h"

namespace vismap {
namespace {

constexpr double kTurn = 0.01;         // [s]
constexpr double kStatusPeriod = 0.5;  // [s]
constexpr double kSilence = 5;         // [s]
constexpr double kTellDropsFor = 10;   // [s]

}  // namespace

Result<std::unique_ptr<Adapter>> Adapter::Create(const AdapterOptions& options, Bus* bus,
                                                 Status* status, RobotBus* robot,
                                                 OutputReport* outputs) {
  std::unique_ptr<Adapter> adapter(new Adapter(options, bus, status, robot, outputs));
  Result<CameraJoiners> joiners = CameraJoiners::Create(
      adapter->cameras_, [made = adapter.get()](size_t camera, ForeignFrame&& frame) {
        made->Publish(made->cameras_[camera], std::move(frame));
      });
  if (!joiners) return tl::unexpected(joiners.error());
  adapter->joiners_ = std::make_unique<CameraJoiners>(std::move(*joiners));
  status->SetFindings("robot's bus", robot->Problems());
  return adapter;
}

// The wall clock at the start, and from there on a clock that never jumps.
int64_t Adapter::Now() const {
  return start_wall_ + static_cast<int64_t>((MonotonicSeconds() - start_) * 1e6);
}

// Computers without a battery for their clock set it when they reach the network.
void Adapter::FollowWallClock() {
  constexpr int64_t kStep = 10'000;  // less may be jitter [us]
  constexpr int64_t kUndisturbed = 1'000;
  const int64_t before = Now(), wall = WallUtime();
  if (Now() - before > kUndisturbed || std::abs(wall - before - wall_offset_) < kStep) return;
  wall_offset_ = wall - before;
  LogInfo("the wall clock was set; it is " +
          FormatDuration(1e-6 * static_cast<double>(std::abs(wall_offset_))) +
          (wall_offset_ < 0 ? " behind" : " ahead of") + " that of the start");
  joiners_->SetWallOffset(wall_offset_);
}

void Adapter::Run() {
  start_wall_ = WallUtime();
  start_ = MonotonicSeconds();
  bus_->Every(kStatusPeriod, [this] { UpdateStatus(); });
  status_->Set(ProcessState::kReady);
  while (!bus_->stop_requested()) {
    FollowWallClock();
    const bool is_all =
        robot_->Spin(kTurn, [&](const std::string& channel, std::span<const uint8_t> data) {
          const Result<void> added = joiners_->Add(channel, data, Now());
          if (!added) LogWarningRateLimited(channel, added.error().message);
        });
    // A frame is not given up while what it waits for has perhaps arrived.
    if (is_all) joiners_->Advance(Now());
    bus_->Spin(0);
  }
  joiners_->Finish();
}

void Adapter::Publish(const AdapterCameraOptions& camera, ForeignFrame&& frame) {
  status_->AddTiming("waiting for poses", static_cast<double>(Now() - frame.received) / 1e3);
  const StageTimer timer(status_, "publishing");
  const int64_t utime = frame.utime;
  bus_->Publish(kRgbdFrameChannel, ToMessage(std::move(frame), camera));
  status_->SetCounter("newest_utime.camera" + std::to_string(camera.camera_id), utime);
}

std::vector<std::string> Adapter::SilentChannels() const {
  std::vector<std::string> sentences;
  if (MonotonicSeconds() - start_ < kSilence) return sentences;
  std::set<std::string> told;
  for (const FrameJoiner& joiner : joiners_->cameras()) {
    const AdapterCameraOptions& camera = joiner.options();
    for (const std::string& channel : ChannelsOf(camera)) {
      const bool needed = channel != camera.depth_intrinsics_channel;
      const bool heard = std::any_of(joiner.received().begin(), joiner.received().end(),
                                     [&, &pattern = channel](const auto& entry) {
                                       return ChannelMatches(pattern, entry.first);
                                     });
      if (!needed || heard || !told.insert(channel).second) continue;
      sentences.push_back("no message came on " + channel + " at " + robot_->url() +
                          "; start its publisher, or correct the section adapter of the config");
    }
  }
  return sentences;
}

// What was lost, for a while after each loss.
void Adapter::TellLosses() {
  const auto is_new = [](int64_t total, Losses* losses) {
    if (total != std::exchange(losses->before, total)) losses->last = MonotonicSeconds();
    return MonotonicSeconds() - losses->last < kTellDropsFor;
  };
  const int64_t dropped = joiners_->dropped(), ignored = joiners_->ignored();
  status_->SetCounter("images_dropped", dropped);
  status_->SetCounter("poses_and_times_ignored", ignored);
  std::optional<std::string> images, poses;
  if (is_new(dropped, &dropped_)) {
    images = FormatCount(dropped, "image or message", "images or messages") + " became no frame (" +
             FormatCount(joiners_->frames(), "frame") + " did): " + joiners_->DroppedText();
  }
  if (is_new(ignored, &ignored_))
    poses = FormatCount(ignored, "pose or time was", "poses or times were") +
            " ignored: " + joiners_->IgnoredText();
  status_->SetFinding("dropped", images);
  status_->SetFinding("ignored", poses);
}

void Adapter::UpdateStatus() {
  const int64_t frames = joiners_->frames();
  status_->SetCounter("frames", frames);
  status_->SetCounter("frames_waiting", joiners_->waiting());
  status_->SetCounter("robot_reconnects", robot_->reconnects());
  TellLosses();
  if (outputs_ != nullptr) outputs_->MoveTo(status_);
  std::vector<std::string> silent = SilentChannels();
  if (!robot_->connected())
    silent = {"there is no connection to the robot's bus at " + robot_->url()};
  status_->SetFindings("channels", silent);
  if (frames > 0) {
    status_->Set(ProcessState::kRunning);
  } else {
    status_->Set(ProcessState::kWaiting, silent.empty() ? "no frame yet" : silent.front());
  }
}

}  // namespace vismap
