#include "plausibility/time_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Optional;

std::optional<std::string> FindingAtSteps(int64_t step, int frames = 10) {
  TimeCheck check;
  for (int i = 0; i < frames; ++i) check.Add(1000 + step * i);
  return check.Finding();
}

TEST(TimeCheck, SaysNothingAboutUsualTimes) {
  EXPECT_EQ(FindingAtSteps(33'333), std::nullopt);
  EXPECT_EQ(FindingAtSteps(1'000), std::nullopt);      // 1000 images a second
  EXPECT_EQ(FindingAtSteps(5'000'000), std::nullopt);  // one in five seconds
  TimeCheck paused;
  for (int i = 0; i < 10; ++i) paused.Add(33'333 * i + (i > 4 ? int64_t{3600'000'000} : 0));
  EXPECT_EQ(paused.Finding(), std::nullopt);
}

TEST(TimeCheck, TellsThatTimesStandStill) {
  EXPECT_THAT(FindingAtSteps(0, 6),
              Optional(AllOf(HasSubstr("5 frames of 6"), HasSubstr("1000 is the last one"))));
}

TEST(TimeCheck, TellsOtherUnits) {
  EXPECT_THAT(FindingAtSteps(33'333'333), Optional(HasSubstr("nanoseconds")));
  EXPECT_THAT(FindingAtSteps(33), Optional(HasSubstr("milliseconds")));
  EXPECT_EQ(FindingAtSteps(33, 3), std::nullopt) << "too few frames";
}

TEST(TimeCheck, NanosecondsOfAFastCameraAreTold) {
  TimeCheck check;  // at 60 Hz, 16'666'667 ns could be the microseconds of a slow camera
  for (int i = 0; i < 10; ++i) check.Add(1'764'500'000'000'000'000 + 16'666'667 * int64_t{i});
  EXPECT_THAT(check.Finding(), Optional(AllOf(HasSubstr("2200"), HasSubstr("nanoseconds"))));
  TimeCheck now;
  for (int i = 0; i < 10; ++i) now.Add(1'764'500'000'000'000 + 16'667 * i);
  EXPECT_EQ(now.Finding(), std::nullopt);
}

TEST(TimeCheck, TellsThatTimeRunsBackward) {
  EXPECT_THAT(FindingAtSteps(-33), Optional(HasSubstr("older utime")));
}

TEST(TimeCheck, AnyTimesAreCounted) {
  TimeCheck check;
  for (const int64_t utime : {std::numeric_limits<int64_t>::min(),
                              std::numeric_limits<int64_t>::max(), int64_t{0}, int64_t{1}})
    check.Add(utime);
  EXPECT_EQ(check.Finding().has_value(), true);
}

}  // namespace
}  // namespace vismap
