#include "map_server/checkpoints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "map_server/small_frames.h"
#include "session/map_frame.h"

namespace vismap {
namespace {

using testing_support::CoarseMap;
using testing_support::SmallMessage;

class CopiesOfAMap : public ::testing::Test {
 protected:
  void Integrate(Checkpoints* checkpoints) {
    checkpoints->AddIfDue(session_);
    MapFrame(*Decode(SmallMessage(1000 * ++frames_)), &session_);
  }
  /// The revision of the newest copy before a frame; -1 = there is none.
  static int64_t Before(const Checkpoints& checkpoints, int64_t revision) {
    const auto found = checkpoints.NewestBefore(revision);
    return found ? found->map().revision : -1;
  }

  MapSession session_{CoarseMap(), {}};
  int64_t frames_ = 0;
};

TEST_F(CopiesOfAMap, AreMadeEverySoManyFramesAndStayAsTheyAre) {
  Checkpoints checkpoints(3, size_t{1} << 40);
  std::vector<std::string> hashes;
  for (int i = 0; i < 8; ++i) {
    hashes.push_back(HashMap(session_.map()));
    Integrate(&checkpoints);
  }
  EXPECT_EQ(checkpoints.size(), 3u);
  EXPECT_EQ(Before(checkpoints, 1), 0);
  EXPECT_EQ(Before(checkpoints, 3), 0) << "a copy after frame 3 has it";
  EXPECT_EQ(Before(checkpoints, 4), 3);
  EXPECT_EQ(Before(checkpoints, 100), 6);
  EXPECT_EQ(HashMap(checkpoints.NewestBefore(6)->map()), hashes[3]);
  checkpoints.DropFrom(6);
  EXPECT_EQ(Before(checkpoints, 100), 3);
  checkpoints.DropFrom(0);
  EXPECT_EQ(Before(checkpoints, 100), -1);
}

TEST_F(CopiesOfAMap, AreFewOfWhichTheFirstStays) {
  Checkpoints checkpoints(1, size_t{1} << 40);
  for (int i = 0; i < 12; ++i) Integrate(&checkpoints);
  EXPECT_EQ(checkpoints.size(), Checkpoints::kMost);
  EXPECT_EQ(Before(checkpoints, 1), 0);
  EXPECT_EQ(Before(checkpoints, 5), 0);
  EXPECT_EQ(Before(checkpoints, 12), 11);
}

TEST_F(CopiesOfAMap, TakeNoMoreThanTheirLimit) {
  Integrate(std::make_unique<Checkpoints>(1, 1).get());
  Checkpoints checkpoints(1, BytesOf(session_.map()) * 5 / 2);
  for (int i = 0; i < 4; ++i) Integrate(&checkpoints);
  EXPECT_LE(checkpoints.bytes(), BytesOf(session_.map()) * 5 / 2);
  EXPECT_EQ(Before(checkpoints, 100), 4) << "the newest stays";
}

}  // namespace
}  // namespace vismap
