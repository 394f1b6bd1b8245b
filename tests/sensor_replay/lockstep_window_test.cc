#include "sensor_replay/lockstep_window.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace vismap {
namespace {

FrameKey Key(int64_t utime, int camera = 0) { return {CameraId{camera}, utime}; }

LockstepWindow ThreeSent(double now) {
  LockstepWindow window(3, 5.0);
  for (size_t i = 0; i < 3; ++i) window.Sent(i, Key(100 + static_cast<int64_t>(i)), now);
  return window;
}

TEST(LockstepWindow, IsFullUntilTheFirstCommit) {
  LockstepWindow window = ThreeSent(0);
  EXPECT_FALSE(window.HasRoom());
  EXPECT_THROW(window.Sent(3, Key(103), 0), std::logic_error);
  EXPECT_TRUE(window.Commit(Key(101), 1));
  EXPECT_TRUE(window.HasRoom());
}

TEST(LockstepWindow, RepeatedAndForeignCommitsDoNotCount) {
  LockstepWindow window = ThreeSent(0);
  EXPECT_TRUE(window.Commit(Key(100), 1));
  EXPECT_FALSE(window.Commit(Key(100), 1));
  EXPECT_FALSE(window.Commit(Key(100, 7), 1));
  EXPECT_EQ(window.in_flight(), 2U);
}

TEST(LockstepWindow, WithoutCommitsAllFramesAreDueOnceInOrder) {
  LockstepWindow window = ThreeSent(0);
  window.Commit(Key(101), 2);
  EXPECT_FALSE(window.NextResend(6.9));
  EXPECT_EQ(window.NextResend(7), 0U);
  EXPECT_EQ(window.NextResend(7), 2U);
  EXPECT_FALSE(window.NextResend(7));
  EXPECT_FALSE(window.NextResend(11.9));
  EXPECT_EQ(window.NextResend(12), 0U);
}

TEST(LockstepWindow, CommitsDelayTheResend) {
  LockstepWindow window(100, 5.0);
  for (size_t i = 0; i < 50; ++i) window.Sent(i, Key(static_cast<int64_t>(i)), 0);
  for (int i = 0; i < 49; ++i) {
    window.Commit(Key(i), i);
    EXPECT_FALSE(window.NextResend(i)) << "a slow server still commits";
  }
}

TEST(LockstepWindow, IsStalledWhenNoCommitArrivesForFramesInFlight) {
  LockstepWindow window(3, 1.0);
  EXPECT_FALSE(window.Stalled(100));
  window.Sent(0, Key(1, 0), 100);
  window.Sent(1, Key(2, 0), 100);
  EXPECT_FALSE(window.Stalled(100.9));
  EXPECT_TRUE(window.Stalled(101));
  EXPECT_TRUE(window.Commit(Key(1, 0), 101));
  EXPECT_FALSE(window.Stalled(101.5));
  EXPECT_TRUE(window.IsInFlight(Key(2, 0)));
  window.Clear();
  EXPECT_FALSE(window.IsInFlight(Key(2, 0)));
  EXPECT_FALSE(window.Stalled(200));
  EXPECT_TRUE(window.HasRoom());
}

TEST(LockstepWindow, IsEmptyAfterAllCommits) {
  LockstepWindow window = ThreeSent(0);
  for (const int64_t utime : {102, 100, 101}) EXPECT_TRUE(window.Commit(Key(utime), 1));
  EXPECT_TRUE(window.empty());
  EXPECT_FALSE(window.NextResend(1000));
}

// The order of frames is that of the sequence also across cameras.
TEST(LockstepWindow, AnotherCameraWaitsUntilAllAreCommitted) {
  LockstepWindow window(3, 1.0);
  const FrameKey first{CameraId{1}, 100}, second{CameraId{1}, 200}, other{CameraId{2}, 150};
  EXPECT_TRUE(window.MaySend(first));
  window.Sent(0, first, 0);
  EXPECT_TRUE(window.MaySend(second));
  EXPECT_FALSE(window.MaySend(other));
  window.Sent(1, second, 0);
  window.Commit(first, 0);
  EXPECT_FALSE(window.MaySend(other));
  window.Commit(second, 0);
  EXPECT_TRUE(window.MaySend(other));
}

}  // namespace
}  // namespace vismap
