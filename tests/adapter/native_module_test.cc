#include "adapter/native_module.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> Words(const std::string& line,
                               const std::vector<std::string>& words = {}) {
  const Result<std::vector<std::string>> found = WithStdinConfig(words, line);
  EXPECT_TRUE(found) << found.error().message;
  return found.value_or(std::vector<std::string>{});
}

std::string ErrorIn(const std::string& line) {
  const Result<std::vector<std::string>> found = WithStdinConfig({}, line);
  return found ? "" : found.error().message;
}

TEST(NativeModule, NamesOfOptionsMayHaveUnderscores) {
  EXPECT_THAT(WithDashes({"a_b", "--color_image", "/a_b#c.D", "--camera_id=1_0", "-x_y"}),
              ElementsAre("a_b", "--color-image", "/a_b#c.D", "--camera-id=1_0", "-x_y"));
}

TEST(NativeModule, TakesChannelsAndFieldsFromTheLineOfDimos) {
  EXPECT_THAT(Words(R"({"topics": {"color_image": "/c#sensor_msgs.Image", "tf": null},
                "config": {"camera_id": 3, "swap_red_blue": true, "intrinsics": [500, 500.5, 1, 2]},
                "session": {"id": "x"}, "qos": {"color_image": "best_effort"}})"),
              ElementsAre("--color-image=/c#sensor_msgs.Image", "--camera-id=3",
                          "--swap-red-blue=true", "--intrinsics=500,500.5,1,2"));
  EXPECT_THAT(Words(R"({"topics": {}, "config": null})", {"vismap-adapter"}),
              ElementsAre("vismap-adapter"));
}

TEST(NativeModule, TheCommandLineComesFirst) {
  const std::vector<std::string> words = {"--camera-id", "1", "--root=map"};
  EXPECT_EQ(Words(R"({"config": {"camera_id": 3, "root": "world"}})", words), words);
}

TEST(NativeModule, SaysWhatIsWrongWithTheLine) {
  EXPECT_THAT(ErrorIn("[1]"), HasSubstr("expected one line with a JSON object"));
  EXPECT_THAT(ErrorIn("{\"topics\": 3}"), HasSubstr("'topics' is no object"));
  EXPECT_THAT(ErrorIn("{\"config\": {\"mount\": {\"x\": 1}}}"), HasSubstr("'mount' in 'config'"));
  EXPECT_THAT(ErrorIn("{\"config\": {\"list\": [[1]]}}"), HasSubstr("'list' in 'config'"));
}

TEST(NativeModule, IsAskedForTheLine) {
  EXPECT_TRUE(WantsStdinConfig({"x", "--stdin-config", "true"}));
  EXPECT_TRUE(WantsStdinConfig({"--stdin-config=true"}));
  EXPECT_FALSE(WantsStdinConfig({"--stdin-config", "false"}));
  EXPECT_FALSE(WantsStdinConfig({"--stdin-config"}));
}

TEST(NativeModule, OnlyLcmReachesTheAdapter) {
  EXPECT_EQ(TransportProblem(""), "");
  EXPECT_EQ(TransportProblem("LCM"), "");
  EXPECT_THAT(TransportProblem("zenoh"), HasSubstr("DIMOS_TRANSPORT is 'zenoh'"));
}

}  // namespace
}  // namespace vismap
