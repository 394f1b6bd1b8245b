#include "foreign/time_gate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace vismap {
namespace {

using ::testing::ElementsAre;

/// A gate with a slack of 10 for items that are their own times, and what it let through.
struct Gate {
  bool Add(int64_t utime, int64_t received) {
    return gate.Add(utime, utime, received, [this](TimeGate<int64_t>::Timed&& timed) {
      used.push_back(timed.item);
      if (timed.stepped_back) steps.push_back(timed.item);
    });
  }
  TimeGate<int64_t> gate{10};
  std::vector<int64_t> used, steps;
};

TEST(TimeGate, LetsTimesThroughThatGoOn) {
  Gate gate;
  for (const int64_t time : {100, 110, 105, 105, 130, 1000}) EXPECT_FALSE(gate.Add(time, time));
  EXPECT_THAT(gate.used, ElementsAre(100, 110, 105, 105, 130, 1000));
  EXPECT_FALSE(gate.Add(1009, 5000)) << "the sender paused";
  EXPECT_EQ(gate.used.back(), 1009);
}

TEST(TimeGate, LeavesOutOneWrongTime) {
  for (const int64_t wrong : {0, 80, 140, 9999}) {
    Gate gate;
    gate.Add(100, 0);
    EXPECT_FALSE(gate.gate.sure());
    gate.Add(101, 1);
    EXPECT_TRUE(gate.gate.sure());
    EXPECT_FALSE(gate.Add(wrong, 2));
    EXPECT_FALSE(gate.gate.sure());
    EXPECT_TRUE(gate.Add(103, 3)) << wrong;
    EXPECT_FALSE(gate.Add(104, 4));
    EXPECT_THAT(gate.used, ElementsAre(100, 101, 103, 104)) << wrong;
  }
}

TEST(TimeGate, LosesOnlyTheFirstItemWhenItsTimeIsWrong) {
  for (const int64_t wrong : {0, 9999}) {
    Gate gate;
    for (const int64_t time : {wrong, int64_t{101}, int64_t{102}, int64_t{103}}) gate.Add(time, 0);
    EXPECT_THAT(gate.used, ElementsAre(wrong, 101, 102, 103));
  }
}

TEST(TimeGate, FollowsAClockThatWasSet) {
  for (const int64_t set : {0, 9999}) {
    Gate gate;
    gate.Add(100, 0);
    EXPECT_FALSE(gate.Add(set, 1));
    EXPECT_FALSE(gate.Add(set + 1, 2));
    EXPECT_FALSE(gate.Add(set + 2, 3));
    EXPECT_THAT(gate.used, ElementsAre(100, set, set + 1, set + 2));
    EXPECT_EQ(gate.steps.size(), set == 0 ? 1u : 0u);
  }
}

TEST(TimeGate, FollowsAClockThatRunsFast) {
  Gate gate;
  for (int64_t i = 0; i < 9; ++i) EXPECT_FALSE(gate.Add(1000 * i, i));
  EXPECT_THAT(gate.used, ElementsAre(0, 1000, 2000, 3000, 4000, 5000, 6000, 7000, 8000));
  EXPECT_FALSE(gate.Add(9000, 9));
  EXPECT_EQ(gate.used.size(), 9u);
  gate.gate.Finish([&](TimeGate<int64_t>::Timed&& timed) { gate.used.push_back(timed.item); });
  EXPECT_EQ(gate.used.back(), 9000);
}

TEST(TimeGate, IsToldWhereTheTimesAre) {
  Gate gate;
  gate.Add(100, 0);
  gate.Add(9000, 0);
  gate.gate.Restart(9001, 0);
  EXPECT_FALSE(gate.Add(9002, 0));
  EXPECT_THAT(gate.used, ElementsAre(100, 9002));
}

}  // namespace
}  // namespace vismap
