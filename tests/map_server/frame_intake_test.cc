#include "map_server/frame_intake.h"

#include <gtest/gtest.h>

#include "session/map_frame.h"
#include "small_frames.h"

namespace vismap {
namespace {

using testing_support::CoarseMap;
using testing_support::SmallKey;
using testing_support::SmallMessage;

class Frames : public ::testing::Test {
 protected:
  Frames() { intake_.SetMap("map"); }
  /// The time of the next frame, which is integrated; -1 = none may be.
  int64_t IntegrateNext() {
    const auto next = intake_.Next(session_);
    if (!next) return -1;
    MapFrame(*Decode(*next), &session_);
    return next->utime;
  }

  FrameIntake intake_;
  MapSession session_{CoarseMap(), {}};
};

TEST_F(Frames, WaitForTheFrameBeforeThem) {
  intake_.Add(SmallMessage(3000, 2000), 0);
  intake_.Add(SmallMessage(2000, 1000), 0);
  EXPECT_EQ(IntegrateNext(), -1);
  EXPECT_EQ(intake_.waiting(), 2u);
  intake_.Add(SmallMessage(1000), 0);
  EXPECT_EQ(IntegrateNext(), 1000);
  EXPECT_EQ(IntegrateNext(), 2000);
  EXPECT_EQ(IntegrateNext(), 3000);
  EXPECT_EQ(IntegrateNext(), -1);
  EXPECT_EQ(intake_.waiting(), 0u);
}

TEST_F(Frames, DoNotWaitForASkippedOne) {
  intake_.Add(SmallMessage(2000, 1000), 0);
  EXPECT_EQ(IntegrateNext(), -1);
  intake_.Skip(SmallKey(1000));
  EXPECT_EQ(IntegrateNext(), 2000);
}

TEST_F(Frames, AreDroppedWhenAnotherMapBegins) {
  intake_.Add(SmallMessage(3000, 2000), 0);
  intake_.Skip(SmallKey(1000));
  intake_.SetMap("map");
  EXPECT_EQ(intake_.waiting(), 1u) << "the same map";
  intake_.SetMap("another map");
  EXPECT_EQ(intake_.waiting(), 0u);
  intake_.Add(SmallMessage(2000, 1000), 0);
  EXPECT_EQ(IntegrateNext(), -1) << "no frame of the new map was skipped";
}

TEST_F(Frames, BeyondALimitAreDropped) {
  const segmented_frame_t message = SmallMessage(2000, 1000);
  int64_t dropped = 0;
  for (int i = 0; i < 300; ++i) {
    segmented_frame_t copy = message;
    copy.frame.utime = 2000 + i;
    intake_.Add(copy, 0);
    dropped += intake_.Trim(0).no_room;
  }
  EXPECT_EQ(dropped, 44);
  EXPECT_EQ(intake_.waiting(), 256u);
  EXPECT_EQ(intake_.waiting_bytes(), 256 * BytesOf(message));
}

TEST_F(Frames, ThatWaitForNothingAreTakenWhateverOthersWaitFor) {
  for (int i = 0; i < 300; ++i) {
    intake_.Add(SmallMessage(5000 + 2 * i, 4999 + 2 * i), 0);
    intake_.Trim(0);
  }
  intake_.Add(SmallMessage(1000), 1);
  EXPECT_EQ(IntegrateNext(), 1000);
  intake_.Add(SmallMessage(2000, 1000), 1);
  EXPECT_EQ(IntegrateNext(), 2000);
  EXPECT_EQ(intake_.Trim(29.9).late, 0);
  EXPECT_EQ(intake_.Trim(30.1).late, 256);
  EXPECT_EQ(intake_.waiting(), 0u);
}

}  // namespace
}  // namespace vismap
