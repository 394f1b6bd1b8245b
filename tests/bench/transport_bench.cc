// Measures on a bus how many frames a running pipeline integrates, how fast, and how long after the
// sensor's message. scripts/bench-transport uses it.
// Usage: transport_bench LCM_URL FRAMES SECONDS
//            Waits for the commits of so many frames. Ends after SECONDS without a message.
//        transport_bench LCM_URL FRAMES SECONDS RATE
//            Sends the frames itself: 168 kB each, as those of the built-in room of 640x480, RATE
//            per second. RATE 0: sends each frame after the commit of the one before.
//        transport_bench LCM_URL commit
//            Commits every frame at once instead of the map server, until it is killed. This
//            measures the time of the transport alone.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>
#include <vismap/rgbd_frame_t.hpp>

#include "runtime/bus.h"
#include "runtime/clock.h"
#include "runtime/peers.h"
#include "runtime/status.h"
#include "wire/frame_key.h"

namespace {

using namespace vismap;

double Quantile(const std::vector<double>& sorted, double part) {
  if (sorted.empty()) return 0;
  return sorted[static_cast<size_t>(part * static_cast<double>(sorted.size() - 1))];
}

int CommitAll(const char* url) {
  auto bus = Bus::Open({url, "map-server", 10, nullptr});
  if (!bus) {
    std::fprintf(stderr, "%s\n", bus.error().message.c_str());
    return 1;
  }
  Status status(bus->get(), "map-server");
  (*bus)->Subscribe<rgbd_frame_t>(kRgbdFrameChannel, [&](const rgbd_frame_t& frame) {
    frame_commit_t commit{};
    commit.utime = frame.utime;
    commit.camera_id = frame.camera_id;
    (*bus)->Publish(kMapCommitChannel, commit);
  });
  status.Set(ProcessState::kReady);
  (*bus)->Run();
  return 0;
}

/// Measures the times between frames and their commits.
class Watch {
 public:
  Watch(Bus* bus, size_t frames, double patience)
      : bus_(*bus), frames_(frames), patience_(patience), last_(MonotonicSeconds()) {
    bus_.Subscribe<frame_commit_t>(kMapCommitChannel, [this](const frame_commit_t& commit) {
      last_ = MonotonicSeconds();
      const auto frame = sent_.find(KeyOf(commit));
      if (commit.status != frame_commit_t::STATUS_INTEGRATED || frame == sent_.end()) return;
      last_commit_ = last_;
      milliseconds_.push_back((last_ - frame->second) * 1e3);
    });
  }

  /// Measures the frames that the sensor sends.
  void SubscribeToSensor() {
    bus_.Subscribe<rgbd_frame_t>(kRgbdFrameChannel,
                                 [this](const rgbd_frame_t& frame) { CountFrame(frame); });
  }

  void SendAll(double rate) {
    rgbd_frame_t frame{};
    frame.depth.assign(168 * 1024, 42);
    frame.depth_size = static_cast<int32_t>(frame.depth.size());
    const double start = MonotonicSeconds();
    for (size_t i = 0; i < frames_ && MonotonicSeconds() - last_ < patience_; ++i) {
      while (rate > 0 && MonotonicSeconds() < start + static_cast<double>(i) / rate) {
        bus_.Spin(start + static_cast<double>(i) / rate - MonotonicSeconds());
      }
      frame.utime = static_cast<int64_t>(i);
      CountFrame(frame);
      bus_.Publish(kRgbdFrameChannel, frame);
      while (rate <= 0 && milliseconds_.size() <= i && MonotonicSeconds() - last_ < patience_) {
        bus_.Spin(0.05);
      }
    }
  }

  void WaitForAll() {
    while (milliseconds_.size() < frames_ && MonotonicSeconds() - last_ < patience_) {
      bus_.Spin(0.05);
    }
  }

  void Print() {
    std::sort(milliseconds_.begin(), milliseconds_.end());
    const double seconds = last_commit_ - first_;
    std::printf("%zu %.2f %.1f %.1f %lld\n", milliseconds_.size(),
                seconds > 0 ? static_cast<double>(milliseconds_.size()) / seconds : 0,
                Quantile(milliseconds_, 0.5), Quantile(milliseconds_, 0.95),
                static_cast<long long>(bytes_));
  }

 private:
  void CountFrame(const rgbd_frame_t& frame) {
    last_ = MonotonicSeconds();
    if (sent_.empty()) first_ = last_;
    sent_.try_emplace(KeyOf(frame), last_);
    bytes_ = std::max<int64_t>(bytes_, frame.getEncodedSize());
  }

  Bus& bus_;
  size_t frames_;
  double patience_;
  std::map<FrameKey, double> sent_;
  std::vector<double> milliseconds_;
  double first_ = 0, last_ = 0, last_commit_ = 0;
  int64_t bytes_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[2]) == "commit") return CommitAll(argv[1]);
  if (argc != 4 && argc != 5) {
    std::fprintf(stderr, "usage: transport_bench LCM_URL FRAMES SECONDS [RATE] | LCM_URL commit\n");
    return 2;
  }
  auto bus = Bus::Open({argv[1], "transport-bench", 10, nullptr});
  if (!bus) {
    std::fprintf(stderr, "%s\n", bus.error().message.c_str());
    return 1;
  }
  const Peers peers(bus->get());
  Watch watch(bus->get(), std::strtoul(argv[2], nullptr, 10), std::strtod(argv[3], nullptr));
  std::printf("ready\n");
  std::fflush(stdout);
  if (argc == 5) {
    while (!peers.IsReady("map-server")) (*bus)->Spin(0.05);
    watch.SendAll(std::strtod(argv[4], nullptr));
  } else {
    watch.SubscribeToSensor();
  }
  watch.WaitForAll();
  watch.Print();
  return 0;
}
