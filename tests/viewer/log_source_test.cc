#include "viewer/log_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "runtime/clock.h"
#include "support/log_builder.h"
#include "support/temp_folder.h"
#include "viewer/timeline.h"

namespace vismap {
namespace {

using testing::HasSubstr;

std::string WhyNot(const std::string& path, VismapConfig config = {}) {
  const auto source = LogSource::Open(path, config);
  return source ? "it opened" : source.error().message;
}

bool WaitUntilDone(const LogSource& source) {
  const double end = MonotonicSeconds() + 60;
  while (!source.recording().state().done && MonotonicSeconds() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return source.recording().state().done;
}

TEST(LogSource, MissingFileIsNamed) {
  EXPECT_THAT(WhyNot("/nowhere/run.lcmlog"), HasSubstr("/nowhere/run.lcmlog"));
}

TEST(LogSource, LogWithoutFramesIsToldWithItsChannels) {
  LogBuilder log;
  log.AddBytes("CAMERA_A", {1, 2, 3}).AddBytes("WHEELS", {1}).AddBytes("CAMERA_A", {4});
  EXPECT_THAT(WhyNot(log.Finish()), HasSubstr("its channels are CAMERA_A, WHEELS"));
}

TEST(LogSource, FolderOfTheRecordingThatIsMissingIsNamed) {
  LogBuilder log;
  const std::string path = log.Frame(100).Finish();
  VismapConfig config;
  config.viewer.log_folder = "/nowhere/at-all";
  EXPECT_THAT(WhyNot(path, config), HasSubstr("/nowhere/at-all"));
  EXPECT_THAT(WhyNot(path, config), HasSubstr("viewer.log_folder"));
}

TEST(LogSource, DamagedLogIsMappedAsFarAsItCanBeReadAndSaysSo) {
  LogBuilder log;
  for (int i = 1; i <= 6; ++i) log.Frame(1000 * i);
  const std::string path = log.Finish();
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 10);
  const auto source = LogSource::Open(path, {});
  ASSERT_TRUE(source) << source.error().message;
  (*source)->Start();
  ASSERT_TRUE(WaitUntilDone(**source));
  const RecordingState state = (*source)->recording().state();
  EXPECT_EQ(state.mapped, 5);
  EXPECT_THAT(state.message, HasSubstr("damaged part"));
  EXPECT_THAT(TimelineText((*source)->recording()), HasSubstr("damaged part"));
  EXPECT_EQ((*source)->recording().Newest()->frames, 5);
}

TEST(LogSource, EndsWhileItMaps) {
  VismapConfig config;
  auto source = LogSource::Open("synthetic:room?frames=4000&width=160", config);
  ASSERT_TRUE(source);
  (*source)->Start();
  const double begin = MonotonicSeconds();
  source->reset();
  EXPECT_LT(MonotonicSeconds() - begin, 20);
}

}  // namespace
}  // namespace vismap
