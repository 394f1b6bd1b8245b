#include "runtime/log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace vismap {
namespace {

using ::testing::HasSubstr;

/// What is written to the log meanwhile.
template <typename Action>
std::string LogOf(const Action& action) {
  ::testing::internal::CaptureStderr();
  action();
  return ::testing::internal::GetCapturedStderr();
}

int64_t Lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

TEST(Log, ASentenceIsOneLineWhateverIsInIt) {
  const std::string text = LogOf([] {
    LogWarning("bad\nerror   map-server: all is lost \x1b[2J");
    LogError("twice\r\n");
    LogWarningRateLimited("a kind", "three\ntimes");
  });
  EXPECT_EQ(Lines(text), 3);
  EXPECT_THAT(text, HasSubstr("bad\\nerror   map-server: all is lost \\x1b[2J"));
  EXPECT_THAT(text, HasSubstr("three\\ntimes"));
}

TEST(Log, WarningsOfOneKindAreLimited) {
  const std::string text = LogOf([] {
    for (int i = 0; i < 100'000; ++i) LogWarningRateLimited("the same kind", "no");
  });
  EXPECT_EQ(Lines(text), 1);
}

TEST(Log, KindsWithNamesFromTheBusAreLimitedTogether) {
  const std::string text = LogOf([] {
    for (int i = 0; i < 100'000; ++i)
      LogWarningRateLimited("slow client " + std::to_string(i), "client is slow");
  });
  EXPECT_LE(Lines(text), 65);
}

TEST(Log, AllOtherLinesTogetherAreLimitedButErrorsAreNot) {
  const std::string text = LogOf([] {
    for (int i = 0; i < 100'000; ++i) LogInfo("connected again");
    LogError("the reason for the end");
  });
  EXPECT_GT(Lines(text), 100);
  EXPECT_LT(Lines(text), 1200);
  EXPECT_THAT(text, HasSubstr("the reason for the end"));
}

TEST(Log, ALongSentenceIsCut) {
  EXPECT_LT(LogOf([] { LogError(std::string(1'000'000, 'x')); }).size(), 9000u);
}

}  // namespace
}  // namespace vismap
