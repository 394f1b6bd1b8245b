#include "detector/newest_frames.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

rgbd_frame_t Frame(int camera, int64_t utime) {
  rgbd_frame_t frame{};
  frame.camera_id = camera;
  frame.utime = utime;
  return frame;
}

TEST(NewestFrames, NewerFrameReplacesTheWaitingOne) {
  NewestFrames frames;
  EXPECT_FALSE(frames.Next());
  EXPECT_FALSE(frames.Add(Frame(0, 1)));
  EXPECT_TRUE(frames.Waits({CameraId{0}, 1}));
  const auto replaced = frames.Add(Frame(0, 2));
  ASSERT_TRUE(replaced);
  EXPECT_EQ(replaced->utime, 1);
  EXPECT_FALSE(frames.Waits({CameraId{0}, 1}));
  const auto next = frames.Next();
  ASSERT_TRUE(next);
  EXPECT_EQ(next->utime, 2);
  EXPECT_FALSE(frames.Next());
}

TEST(NewestFrames, CamerasTakeTurns) {
  NewestFrames frames;
  EXPECT_FALSE(frames.Add(Frame(0, 1)));
  EXPECT_FALSE(frames.Add(Frame(1, 1)));
  for (int64_t utime = 2; utime < 10; ++utime) EXPECT_TRUE(frames.Add(Frame(0, utime)));
  EXPECT_EQ(frames.Next()->utime, 9);
  EXPECT_FALSE(frames.Add(Frame(0, 10))) << "it had its turn, so it waits after the other camera";
  EXPECT_EQ(frames.Next()->camera_id, 1);
  EXPECT_EQ(frames.Next()->utime, 10);
}

TEST(NewestFrames, NumberOfCamerasIsLimited) {
  NewestFrames frames(2);
  EXPECT_FALSE(frames.Add(Frame(0, 1)));
  EXPECT_FALSE(frames.Add(Frame(1, 1)));
  const auto away = frames.Add(Frame(2, 1));
  ASSERT_TRUE(away);
  EXPECT_EQ(away->camera_id, 2);
}

}  // namespace
}  // namespace vismap
