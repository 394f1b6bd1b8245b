#include "bridge/source_sides.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

constexpr BridgeSide kHere = BridgeSide::kLocal, kThere = BridgeSide::kRemote;

TEST(SourceSides, SourceLivesWhereItWasReceivedFirst) {
  SourceSides sides;
  EXPECT_TRUE(sides.LivesOn(kHere, "a", 0));
  EXPECT_TRUE(sides.LivesOn(kThere, "b", 0));
  for (const double now : {0.0, 1.0, 20.0, 40.0, 60.0}) {
    EXPECT_FALSE(sides.LivesOn(kThere, "a", now))
        << "a message that the bridge itself has forwarded";
    EXPECT_TRUE(sides.LivesOn(kHere, "a", now));
    EXPECT_FALSE(sides.LivesOn(kHere, "b", now));
    EXPECT_TRUE(sides.LivesOn(kThere, "b", now));
  }
}

TEST(SourceSides, SilentSourceMayMove) {
  SourceSides sides;
  EXPECT_TRUE(sides.LivesOn(kHere, "a", 0));
  EXPECT_FALSE(sides.LivesOn(kThere, "a", 29));
  EXPECT_TRUE(sides.LivesOn(kThere, "a", 31));
  EXPECT_FALSE(sides.LivesOn(kHere, "a", 32));
}

TEST(SourceSides, NumberOfSourcesIsLimited) {
  SourceSides sides;
  EXPECT_TRUE(sides.LivesOn(kHere, "known", 0));
  int taken = 0;
  for (int i = 0; i < 100000; ++i) taken += sides.LivesOn(kHere, std::to_string(i), 0) ? 1 : 0;
  EXPECT_LT(taken, 10000);
  EXPECT_TRUE(sides.LivesOn(kHere, "known", 0));
}

}  // namespace
}  // namespace vismap
