#include "base/json_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace vismap {
namespace {

std::string ErrorOf(std::string_view text) {
  const auto json = ParseJson(text);
  return json ? "none" : json.error().message;
}

TEST(ParseJson, ReadsWhatIsJson) {
  EXPECT_EQ(ParseJson("{\"a\": [1, 2]}")->at("a").size(), 2u);
  EXPECT_EQ(ParseJson("\xEF\xBB\xBF[]").value(), nlohmann::json::array());
  EXPECT_EQ(ParseJson<nlohmann::ordered_json>("{\"b\":1,\"a\":2}")->begin().key(), "b");
  EXPECT_EQ(ErrorOf("\"" + std::string(1000, '[') + "\""), "none");  // in a string it is text
}

TEST(ParseJson, SaysWhereItIsNone) {
  EXPECT_EQ(ErrorOf("[1,\n 2,,3]"), "line 2, column 4: this is not JSON");
  EXPECT_EQ(ErrorOf(""), "line 1, column 1: this is not JSON");
  EXPECT_EQ(ErrorOf("[1"), "line 1, column 3: this is not JSON");
}

TEST(ParseJson, DeepNestingIsRefused) {
  EXPECT_EQ(ErrorOf(std::string(64, '[') + std::string(64, ']')), "none");
  for (const size_t depth : {65u, 1000000u}) {
    EXPECT_EQ(ErrorOf(std::string(depth, '[') + std::string(depth, ']')),
              "line 1, column 65: nested deeper than 64 levels");
  }
  std::string objects;
  for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
  EXPECT_NE(ErrorOf(objects), "none");
}

TEST(ParseJson, MoreValuesThanMemoryAreRefused) {
  std::string arrays = "[[]";
  for (int i = 0; i < 1000; ++i) arrays += ",[]";
  arrays += "]";
  EXPECT_TRUE(ParseJson(arrays, 1 << 20));
  const auto refused = ParseJson(arrays, 100'000);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "expected values that need at most 100 kB of memory, found values for about 163 kB");
  EXPECT_FALSE(ParseJson("{\"a\":0,\"b\":0,\"c\":0}", 400));
  EXPECT_TRUE(ParseJson("\"" + std::string(300, ',') + "\"", 400)) << "commas in a text";
}

TEST(DescribeJson, IsShortAndWithoutControlCharacters) {
  EXPECT_EQ(DescribeJson(-3), "-3");
  EXPECT_EQ(DescribeJson(nullptr), "null");
  EXPECT_EQ(DescribeJson({1, 2}), "an array of 2 values");
  EXPECT_EQ(DescribeJson(nlohmann::json::object()), "an object");
  EXPECT_EQ(DescribeJson("a\nb\x1b[2J"), "\"a?b?[2J\"");
  EXPECT_EQ(DescribeJson(std::string(100, 'x')), "\"" + std::string(40, 'x') + "...\"");
}

}  // namespace
}  // namespace vismap
