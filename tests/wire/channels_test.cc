#include "wire/channels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::HasSubstr;

TEST(Channels, APrefixHasFewCharactersAndLeavesRoomForTheName) {
  for (const char* good : {"", "vismap/", "/vismap#", "a.b-c_D9", "/"})
    EXPECT_TRUE(CheckChannelPrefix(good)) << good;
  for (const char* bad : {"vis map", "vismap*", "ä", "a\n", "(", "a|b"}) {
    const Result<void> checked = CheckChannelPrefix(bad);
    ASSERT_FALSE(checked) << bad;
    EXPECT_THAT(checked.error().message, HasSubstr("letters, digits, _ - / . and #"));
  }
  const size_t most = kMaxChannelName - std::string(kOctomapInflatedChannel.name).size();
  EXPECT_TRUE(CheckChannelPrefix(std::string(most, 'a')));
  EXPECT_THAT(CheckChannelPrefix(std::string(most + 1, 'a')).error().message,
              HasSubstr("at most 47"));
}

TEST(Channels, AChannelWithThePrefixIsOneOfOurs) {
  EXPECT_EQ(WithoutPrefix("vismap/OCTOMAP", "vismap/"), "OCTOMAP");
  EXPECT_EQ(WithoutPrefix("OCTOMAP", ""), "OCTOMAP");
  EXPECT_EQ(WithoutPrefix("OCTOMAP", "vismap/"), std::nullopt);
  EXPECT_EQ(WithoutPrefix("vismap", "vismap/"), std::nullopt);
}

TEST(Channels, AHubKnowsChannelsOfOursByTheirEnd) {
  EXPECT_EQ(NameOfOurs("OCTOMAP", ""), "OCTOMAP");
  EXPECT_EQ(NameOfOurs("vismap/OCTOMAP", ""), "OCTOMAP");
  EXPECT_EQ(NameOfOurs("a/b.OCTOMAP", "vismap/"), "OCTOMAP");
  EXPECT_EQ(NameOfOurs("ROBOT_STATUS", ""), "ROBOT_STATUS");
  EXPECT_EQ(NameOfOurs("ROBOT_STATUS", "ROBOT_"), "STATUS");
  EXPECT_EQ(NameOfOurs("/map#nav_msgs.OccupancyGrid", ""), "/map#nav_msgs.OccupancyGrid");
  EXPECT_EQ(NameOfOurs("", ""), "");
}

TEST(Channels, AnExpressionMatchesOneName) {
  EXPECT_EQ(ExpressionFor("vismap/OCTOMAP"), "vismap/OCTOMAP");
  EXPECT_EQ(ExpressionFor("a.b+c"), "a\\.b\\+c");
}

}  // namespace
}  // namespace vismap
