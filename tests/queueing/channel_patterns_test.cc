#include "queueing/channel_patterns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <regex>
#include <string>
#include <vector>

namespace vismap {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string>& Channels() {
  static const std::vector<std::string> channels{"RGBD_FRAME",
                                                 "DETECTIONS",
                                                 "SEGMENTED_FRAME",
                                                 "MAP_COMMIT",
                                                 "MAP_DELTA",
                                                 "MESH_DELTA",
                                                 "OBJECTS",
                                                 "OCTOMAP",
                                                 "MAP_REQUEST",
                                                 "MAP_REPLY",
                                                 "STATUS",
                                                 "STATUS2",
                                                 "CAM_0",
                                                 "CAM_1",
                                                 "CAM_10",
                                                 "cam_left",
                                                 "cam_right",
                                                 "POSE",
                                                 "POSE_BODY",
                                                 "/tf#tf2_msgs.TFMessage",
                                                 "a.b",
                                                 "axb",
                                                 "robot/cam:rgb",
                                                 "DRAKE_VIEWER",
                                                 "x",
                                                 "OPENNI_FRAME",
                                                 "/color_image#sensor_msgs.Image",
                                                 "Kamera Tür",
                                                 "TAB\tNAME",
                                                 ""};
  return channels;
}

TEST(ChannelPatterns, AnswersAsRegularExpressionsOfCppDo) {
  for (const std::string pattern : {"RGBD_FRAME",
                                    ".*",
                                    ".+",
                                    "MAP_.*",
                                    "^MAP_.*$",
                                    "(STATUS|OBJECTS)",
                                    "STATUS|OBJECTS",
                                    "CAM_[0-9]+",
                                    "CAM_\\d",
                                    "CAM_[^1].*",
                                    "cam_(left|right)",
                                    ".*_FRAME",
                                    "[A-Z_]+",
                                    "[[:alpha:]_]+",
                                    "\\w+",
                                    "a\\.b",
                                    "a.b",
                                    "(RGBD|SEGMENTED)_FRAME",
                                    "CAM_[01]{1,2}",
                                    "POSE(_BODY)?",
                                    "/tf#.*",
                                    "/.*#sensor_msgs\\.(Image|CameraInfo)",
                                    "x?",
                                    "x*",
                                    "",
                                    "(?!STATUS).*",
                                    "^(?!STATUS|OCTOMAP).*$",
                                    "(?!CAM_)(?!cam_).*",
                                    "(?=MAP_).*REPLY",
                                    "(?!.*FRAME)[A-Z].*",
                                    "(?!STATUS$).*",
                                    "(?:MAP|MESH)_DELTA",
                                    ".*\\bT.*",
                                    "Kamera T.*",
                                    "[^ ]*",
                                    ".*[#:].*",
                                    "(a|b)*",
                                    "((MAP)|(MESH))_.*",
                                    "[]x]+",
                                    "\\S+\\s\\S+",
                                    "(?![a-z])(CAM.*|POSE.*)"}) {
    SCOPED_TRACE(pattern);
    ChannelPatterns patterns;
    ASSERT_TRUE(patterns.Add(pattern));
    const std::regex reference(pattern == "[]x]+" ? "[\\]x]+" : pattern);
    for (const std::string& channel : Channels())
      EXPECT_EQ(patterns.Match(channel), std::regex_match(channel, reference)) << channel;
  }
}

TEST(ChannelPatterns, WhatCannotBeUsedIsRefusedWithItsReason) {
  ChannelPatterns patterns;
  EXPECT_THAT(patterns.Add("(").error().message, HasSubstr("'('"));
  EXPECT_THAT(patterns.Add("[a").error().message, HasSubstr("missing ]"));
  EXPECT_FALSE(patterns.Add("*"));
  EXPECT_FALSE(patterns.Add("(a)\\1"));
  EXPECT_FALSE(patterns.Add("a(?!b)c"));
  EXPECT_FALSE(patterns.Add("(?!a"));
  EXPECT_THAT(patterns.Add("(?!A)B|C").error().message, HasSubstr("need brackets"));
  EXPECT_THAT(patterns.Add(std::string(2000, 'a')).error().message, HasSubstr("2000 characters"));
  EXPECT_FALSE(patterns.Match("a"));
  EXPECT_EQ(patterns.bytes(), 0u);
}

TEST(ChannelPatterns, RemoveUndoesOneAdd) {
  ChannelPatterns patterns;
  ASSERT_TRUE(patterns.Add("A.*") && patterns.Add("A.*") && patterns.Add("B"));
  patterns.Remove("A.*");
  EXPECT_TRUE(patterns.Match("AB"));
  patterns.Remove("A.*");
  EXPECT_FALSE(patterns.Match("AB"));
  patterns.Remove("A.*");
  EXPECT_TRUE(patterns.Match("B"));
  patterns.Remove("B");
  EXPECT_EQ(patterns.bytes(), 0u);
}

// A subscription of 241 characters with nested lookaheads froze a hub for good, and 2.5 kB of
// patterns took 2.3 GB.
TEST(ChannelPatterns, HostilePatternsTakeLittleTimeAndMemory) {
  std::string nested;
  for (int i = 0; i < 40; ++i) nested += "(?=(a*";
  for (int i = 0; i < 40; ++i) nested += ")*)";
  std::string stars, counts, deep(400, '(');
  for (int i = 0; i < 60; ++i) stars += "(.*)*";
  for (int i = 0; i < 8; ++i) counts = "(" + counts + "x{1,100}){1,100}";
  deep += "a" + std::string(400, ')');
  const auto start = std::chrono::steady_clock::now();
  ChannelPatterns patterns;
  for (const std::string& hostile :
       {nested, stars, counts, deep, std::string("(x+x+)+y"),
        std::string("((a{0,30}){0,30}){0,30}"), std::string("(?!" + stars + ")" + stars),
        std::string(".*.*.*.*.*.*.*.*.*.*=.*"), std::string("[\\s\\S]{0,1000}[\\s\\S]{0,1000}")}) {
    static_cast<void>(patterns.Add(hostile));
  }
  for (const char c : {'a', 'x', '='}) patterns.Match(std::string(100'000, c));
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_LT(seconds, 20);  // milliseconds on an idle machine
  EXPECT_LE(patterns.bytes(), ChannelPatterns::kMaxBytes);
}

TEST(ChannelPatterns, OneSetIsBounded) {
  ChannelPatterns patterns;
  int added = 0;
  while (added < 5000 && patterns.Add("a.*" + std::to_string(added))) ++added;
  EXPECT_LT(added, 100);
  EXPECT_LE(patterns.bytes(), ChannelPatterns::kMaxBytes);
}

}  // namespace
}  // namespace vismap
