// The example of a camera driver: as the program that it is, and with cameras that fail.
#define main CameraDriverMain
#include "examples/camera_driver.cc"
#undef main

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <stdexcept>

#include "client/clocks.h"
#include "process/process_harness.h"
#include "runtime/clock.h"
#include "wire/channels.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

/// Hears what a driver says on a bus.
class DriverListener {
 public:
  explicit DriverListener(Bus* bus) {
    bus->Subscribe<rgbd_frame_t>(kRgbdFrameChannel,
                                 [this](const rgbd_frame_t& frame) { frames.push_back(frame); });
    bus->Subscribe<process_status_t>(kStatusChannel, [this](const process_status_t& status) {
      if (status.source != "camera under test") return;
      states[status.state] = status.message;
      for (int32_t i = 0; i < status.n_counters; ++i)
        counters[status.counter_names[static_cast<size_t>(i)]] =
            status.counter_values[static_cast<size_t>(i)];
    });
  }

  std::vector<rgbd_frame_t> frames;
  std::map<std::string, std::string> states;  // state -> its last message
  std::map<std::string, int64_t> counters;
};

TEST(CameraDriver, PublishesAtItsRateUnderItsPrefixAndTellsItsStatus) {
  ProcessBus hub;
  ProcessBus processes(hub, "robot1/");
  DriverListener heard(&processes.bus());
  const int64_t before = WallUtime();
  ChildProcess driver(VISMAP_EXAMPLES_DIR "/camera_driver",
                      {"--lcm-url", processes.url(), "--channel-prefix", "robot1/", "--name",
                       "camera under test", "--camera-id", "7", "--rate", "5", "--frames", "12"},
                      processes.folder());
  ASSERT_TRUE(processes.SpinUntil(
      [&] { return heard.states.count("stopping") > 0 && heard.frames.size() >= 12; }));
  EXPECT_EQ(driver.WaitForExit(), 0) << driver.StandardError();
  EXPECT_THAT(driver.StandardOutput(), HasSubstr("published 12 frames, skipped "));
  EXPECT_THAT(driver.StandardOutput(), HasSubstr("unsent 0"));
  ASSERT_EQ(heard.frames.size(), 12u);
  for (const rgbd_frame_t& frame : heard.frames) {
    EXPECT_EQ(frame.camera_id, 7);
    EXPECT_GT(frame.utime, before);
    EXPECT_LT(frame.utime, WallUtime());
  }
  // The camera gives a frame each 33 ms, of which every sixth is taken.
  const double span = static_cast<double>(heard.frames[11].utime - heard.frames[0].utime) * 1e-6;
  EXPECT_NEAR(span, 11 * 0.2, 0.1);
  EXPECT_EQ(heard.states.count("running"), 1u);
  EXPECT_EQ(heard.counters["frames"], 12);
  EXPECT_EQ(heard.counters["newest_utime.camera7"], heard.frames[11].utime);
  EXPECT_EQ(heard.counters["camera_clock_restarts"], 0);
}

TEST(CameraDriver, SaysWhatIsWrongAndEnds) {
  const TempFolder folder;
  ChildProcess usage(VISMAP_EXAMPLES_DIR "/camera_driver", {"--rate", "fast"}, folder.path());
  EXPECT_EQ(usage.WaitForExit(), 2);
  EXPECT_THAT(usage.StandardError(), HasSubstr("usage: camera_driver"));
  ChildProcess prefix(VISMAP_EXAMPLES_DIR "/camera_driver", {"--channel-prefix", "no spaces"},
                      folder.path());
  EXPECT_EQ(prefix.WaitForExit(), 1);
  EXPECT_THAT(prefix.StandardError(), HasSubstr("prefix"));
}

/// Gives tiny images, as a test wants it.
class TestCamera : public MyCamera {
 public:
  static camera_t Intrinsics() {
    camera_t camera{};
    camera.width = 4;
    camera.height = 2;
    camera.fx = camera.fy = 4;
    camera.cx = 1.5;
    camera.cy = 0.5;
    return camera;
  }
  std::optional<Images> WaitForImages() {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (++given > most) throw std::runtime_error("the cable was pulled");
    if (given > silent_after) return std::nullopt;
    return Images{first_s + 0.01 * given, std::vector<uint8_t>(24, 9),
                  std::vector<uint16_t>(8, static_cast<uint16_t>(given.load()))};
  }
  std::optional<Pose> PoseAt(double device_s) {
    std::this_thread::sleep_for(std::chrono::duration<double>(pose_takes_s));
    if (pose_fails) throw std::runtime_error("the tracker has ended");
    if (lost) return std::nullopt;
    return MyCamera::PoseAt(device_s);
  }

  std::atomic<int> given{0};
  int most = 1000000, silent_after = 1000000;
  double first_s = 50, pose_takes_s = 0;
  bool pose_fails = false;
  std::atomic<bool> lost{false};
};

class DriverTest : public ::testing::Test {
 protected:
  DriverTest() : heard(&processes.bus()) {
    options.client.url = processes.url();
    options.client.name = "camera under test";
    options.rate_hz = 0;
  }

  /// Runs the driver in a thread while the bus is handled. Returns why it ended.
  std::string Run() {
    std::atomic<bool> done{false};
    std::string reason;
    std::thread running([&] {
      Client client(options.client);
      Driver driver(options, &camera, &client);
      reason = driver.Run();
      skipped = driver.skipped();
      for (int i = 0; i < 12; ++i) client.Handle(0.1);  // until the next STATUS
      done = true;
    });
    processes.SpinUntil([&] {
      meanwhile();
      return done.load();
    });
    running.join();
    return reason;
  }

  ProcessBus processes;
  DriverListener heard;
  DriverOptions options;
  TestCamera camera;
  std::function<void()> meanwhile = [] {};
  int64_t skipped = 0;
};

TEST_F(DriverTest, DropsOldFramesAndCountsThemWhenPublishingIsSlow) {
  camera.pose_takes_s = 0.1;
  options.frames = 8;
  EXPECT_EQ(Run(), "");
  ASSERT_EQ(heard.frames.size(), 8u);
  EXPECT_GT(skipped, 30);
  EXPECT_GT(heard.counters["frames_skipped"], 30);
  for (size_t i = 1; i < heard.frames.size(); ++i) {
    // About ten frames lie between two that are published, not one.
    EXPECT_GT(heard.frames[i].utime, heard.frames[i - 1].utime + 50000);
    EXPECT_GT(heard.frames[i].depth[0], heard.frames[i - 1].depth[0] + 4);
  }
}

TEST_F(DriverTest, EndsWithTheReasonWhenTheCameraOrThePoseFails) {
  camera.most = 20;
  EXPECT_EQ(Run(), "the cable was pulled");
  EXPECT_GT(heard.frames.size(), 5u);
  camera.most = 1000000;
  camera.pose_fails = true;
  EXPECT_EQ(Run(), "the tracker has ended");
  camera.pose_fails = false;
  camera.first_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(Run(), HasSubstr("the time stamp of the camera is"));
}

TEST_F(DriverTest, SaysWhatItWaitsFor) {
  camera.lost = true;
  options.frames = 5;
  meanwhile = [&] {
    if (heard.counters["frames_without_pose"] > 0) camera.lost = false;
  };
  EXPECT_EQ(Run(), "");
  EXPECT_EQ(heard.states["waiting"], "there is no pose of the camera");
  EXPECT_EQ(heard.counters["frames"], 5);
  camera.given = 0;
  camera.silent_after = 2;
  camera.most = 300;
  heard.states.clear();
  EXPECT_EQ(Run(), "the cable was pulled");
  EXPECT_EQ(heard.states["waiting"], "the camera has given no images for two seconds");
}

}  // namespace
}  // namespace vismap
