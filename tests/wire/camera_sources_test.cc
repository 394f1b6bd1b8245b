#include "wire/camera_sources.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST(CameraSources, TwoProcessesWithOneNameAreNoticedAndARestartIsNone) {
  CameraSources sources;
  for (const int64_t seq : {0, 1, 2, 0, 1, 2})
    EXPECT_EQ(sources.Add(CameraId{0}, "replay", seq, 1), std::nullopt);
  EXPECT_EQ(sources.Add(CameraId{0}, "replay", 0, 1), std::nullopt);
  const auto told = sources.Add(CameraId{0}, "replay", 0, 1);
  ASSERT_TRUE(told);
  EXPECT_TRUE(IsAboutSharedCamera(*told, "replay"));
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
