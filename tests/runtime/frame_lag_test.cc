#include "runtime/frame_lag.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

FrameKey Key(double seconds, int camera = 0) {
  return {CameraId{camera}, static_cast<int64_t>(seconds * 1e6)};
}

TEST(FrameLag, IsTheTimeBetweenTheNewestFrameAndTheLastOneThatIsDone) {
  FrameLag lag;
  EXPECT_EQ(lag.DataSeconds(), 0);
  lag.Seen(Key(100), 0);
  lag.Done(Key(100));
  EXPECT_EQ(lag.DataSeconds(), 0);
  for (int i = 1; i <= 30; ++i) lag.Seen(Key(100 + i), 2.0 * i);  // played at half the speed
  EXPECT_DOUBLE_EQ(lag.DataSeconds(), 30);
  EXPECT_DOUBLE_EQ(lag.WaitSeconds(60), 58);
  lag.Done(Key(110));
  EXPECT_DOUBLE_EQ(lag.DataSeconds(), 20);
  EXPECT_DOUBLE_EQ(lag.WaitSeconds(60), 38);
  lag.Done(Key(130));
  EXPECT_EQ(lag.DataSeconds(), 0);
  EXPECT_EQ(lag.WaitSeconds(1000), 0);
}

TEST(FrameLag, IsThatOfTheCameraThatIsFarthestBehind) {
  FrameLag lag;
  for (const int camera : {0, 1}) {
    lag.Seen(Key(1000 * camera, camera), 0);
    lag.Done(Key(1000 * camera, camera));
  }
  lag.Seen(Key(3, 0), 5);
  lag.Seen(Key(1007, 1), 6);
  EXPECT_DOUBLE_EQ(lag.DataSeconds(), 7);
  EXPECT_DOUBLE_EQ(lag.WaitSeconds(8), 3);
}

TEST(FrameLag, FramesThatArriveWhileNewerOnesAreKnownAreNotNew) {
  FrameLag lag;
  process_status_t camera{};
  camera.source = "camera";
  camera.counter_names = {"newest_utime.camera0"};
  camera.counter_values = {50'000'000};
  lag.Seen(camera, 0);
  for (int i = 41; i <= 50; ++i) {
    lag.Seen(Key(i), i);
    lag.Done(Key(i));
    EXPECT_DOUBLE_EQ(lag.DataSeconds(), 50 - i);
  }
}

TEST(FrameLag, ASequenceThatBeginsAtAnEarlierTimeIsNoLag) {
  FrameLag lag;
  lag.Seen(Key(100), 0);
  lag.Done(Key(100));
  for (int i = 0; i < 10; ++i) {
    lag.Seen(Key(i), i);
    lag.Done(Key(i));
    EXPECT_EQ(lag.DataSeconds(), 0);
  }
  process_status_t camera{};
  camera.source = "camera";
  camera.counter_names = {"newest_utime.camera0"};
  for (const int64_t utime : {80'000'000, 81'000'000, 20'000'000}) {  // 81 was lost
    camera.counter_values = {utime};
    lag.Seen(camera, 0);
  }
  lag.Seen(Key(20), 0);
  lag.Done(Key(20));
  EXPECT_EQ(lag.DataSeconds(), 0);
}

TEST(FrameLag, ReadsWhatProcessesTell) {
  FrameLag lag;
  process_status_t status{};
  status.counter_names = {"frames", "newest_utime.camera0", "newest_utime.camera7",
                          "newest_utime.camera7x"};
  status.counter_values = {5, 1'000'000, 2'000'000, 9'000'000};
  lag.Seen(status, 0);
  status.counter_values = {5, 1'500'000, 6'000'000, 9'000'000};
  lag.Seen(status, 1);
  lag.Done(Key(1));
  lag.Done(Key(3, 7));
  EXPECT_DOUBLE_EQ(lag.DataSeconds(), 3);
}

TEST(FrameLag, ItsMemoryIsBounded) {
  FrameLag lag;
  for (int i = 0; i < 100'000; ++i) lag.Seen(Key(i), i);
  for (int camera = 1; camera < 1000; ++camera) lag.Seen(Key(1e6 * camera, camera), 0);
  EXPECT_DOUBLE_EQ(lag.WaitSeconds(100'000), 100'000);
  lag.Done(Key(99'999));
  EXPECT_EQ(lag.DataSeconds(), 0);
}

}  // namespace
}  // namespace vismap
