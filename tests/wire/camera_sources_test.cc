#include "wire/camera_sources.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

namespace vismap {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

TEST(CameraSources, TwoProcessesWithOneCameraAreNoticed) {
  CameraSources sources;
  EXPECT_EQ(sources.Add(CameraId{0}, "left", 0, 0), std::nullopt);
  EXPECT_EQ(sources.Add(CameraId{1}, "right", 0, 0.1), std::nullopt) << "a camera of its own";
  const auto told = sources.Add(CameraId{0}, "right", 1, 0.2);
  EXPECT_THAT(told, Optional(HasSubstr("camera 0")));
  ASSERT_TRUE(told);
  EXPECT_TRUE(IsAboutSharedCamera(*told, "left"));
  EXPECT_TRUE(IsAboutSharedCamera(*told, "right"));
  EXPECT_FALSE(IsAboutSharedCamera(*told, "righ"));
  EXPECT_FALSE(IsAboutSharedCamera("left out: 3 frames of 'left'", "left"));
}

TEST(CameraSources, SourceThatIsRestartedWithAnotherNameIsNoProblem) {
  CameraSources sources;
  EXPECT_EQ(sources.Add(CameraId{0}, "before", 7, 0), std::nullopt);
  EXPECT_EQ(sources.Add(CameraId{0}, "after", 0, CameraSources::kSilence + 1), std::nullopt);
}

// The sentence about the last of these numbers of one source, which come 0.1 s after each other.
std::optional<std::string> Told(const std::vector<int64_t>& numbers, double step = 0.1) {
  CameraSources sources;
  std::optional<std::string> told;
  double now = 0;
  for (const int64_t seq : numbers) told = sources.Add(CameraId{0}, "replay", seq, now += step);
  return told;
}

TEST(CameraSources, TwoProcessesWithOneNameAreNoticed) {
  const std::vector<std::vector<int64_t>> of_twins = {
      {0, 0, 1, 1, 2, 2, 3, 3},                                         // started together
      {100, 101, 0, 102, 103, 1, 104, 105, 2, 106},                     // the second one is slower
      {100, 0, 1, 2, 101, 3, 4, 5, 102, 6, 7, 8, 103, 9, 10, 11, 104},  // the second one is faster
  };
  for (const auto& numbers : of_twins) {
    const auto told = Told(numbers);
    ASSERT_TRUE(told) << numbers.size();
    EXPECT_TRUE(IsAboutSharedCamera(*told, "replay"));
  }
}

TEST(CameraSources, AProcessThatIsRestartedAgainAndAgainIsOne) {
  std::vector<int64_t> numbers;
  for (const int count : {12, 12, 12, 12, 3, 5, 20, 40, 41, 1, 7})
    for (int seq = 0; seq < count; ++seq) numbers.push_back(seq);
  for (size_t n = 1; n <= numbers.size(); ++n)
    EXPECT_EQ(Told({numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(n)}, 0.02),
              std::nullopt)
        << n;
}

TEST(CameraSources, AMessageThatArrivesTwiceNowAndThenIsNoOtherProcess) {
  std::vector<int64_t> numbers;
  for (int64_t seq = 0; seq < 1000; ++seq) {
    numbers.push_back(seq);
    if (seq % 100 == 99) numbers.push_back(seq);
  }
  EXPECT_EQ(Told(numbers), std::nullopt);
}

TEST(CameraSources, NamesAreBounded) {
  CameraSources sources;
  for (int i = 0; i < 100000; ++i) {
    const auto told = sources.Add(CameraId{0}, "flood" + std::to_string(i), i, 1);
    EXPECT_LT(told.value_or("").size(), 20000U);
  }
}

TEST(CameraSources, ManyCamerasThatHaveGoneTakeNoRoomFromNewOnes) {
  CameraSources sources;
  for (int i = 0; i < 100000; ++i) sources.Add(CameraId{i}, "flood", i, 1);
  EXPECT_LE(sources.cameras(), CameraSources::kMaxSources);
  const double later = 2 + CameraSources::kSilence;
  EXPECT_EQ(sources.Add(CameraId{7}, "left", 0, later), std::nullopt);
  EXPECT_THAT(sources.Add(CameraId{7}, "right", 0, later), Optional(HasSubstr("camera 7")));
  EXPECT_EQ(sources.cameras(), 1u);
}

}  // namespace
}  // namespace vismap
