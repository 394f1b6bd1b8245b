#include "viewer/moment_maps.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "runtime/clock.h"
#include "sequence_mapper/map_sequence.h"

namespace vismap {
namespace {

constexpr const char* kLog = "synthetic:room?frames=40&width=96";

std::shared_ptr<const LoadedMap> WaitFor(MomentMaps* maps, int64_t frames) {
  const double end = MonotonicSeconds() + 60;
  std::shared_ptr<const LoadedMap> map;
  while ((map = maps->Get(frames)) == nullptr && MonotonicSeconds() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return map;
}

std::string OfflineHash(const VismapConfig& config, int64_t frames) {
  const auto dataset = OpenRecording(kLog, "");
  const auto detections = OpenRecordedDetections(kLog);
  MapSession session(config, {});
  StageTimes times;
  const auto proceed = [&](size_t) { return session.map().revision < frames; };
  EXPECT_TRUE(
      MapSequence({*dataset->dataset, detections->get()}, config, proceed, &session, &times));
  return HashMap(session.map());
}

TEST(MomentMaps, AnyMomentIsTheMapOfSoManyFramesBitForBit) {
  VismapConfig config;
  config.grid.voxel_size_m = 0.03;
  DeriveOptions(&config);
  const auto source = LogSource::Open(kLog, config);
  ASSERT_TRUE(source) << source.error().message;
  (*source)->Start();
  while (!(*source)->recording().state().done)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  MomentMaps maps(source->get());
  for (const int64_t frames : {37, 5, 32, 40, 37}) {
    const std::shared_ptr<const LoadedMap> map = WaitFor(&maps, frames);
    ASSERT_NE(map, nullptr) << frames;
    EXPECT_EQ(map->map.revision, frames);
    EXPECT_EQ(HashMap(map->map), OfflineHash(config, frames)) << frames;
    EXPECT_EQ(map->metadata.trajectory.size(), static_cast<size_t>(frames));
  }
}

// Which frames the map refuses depends on what it knows already.
TEST(MomentMaps, FramesThatWereRefusedBeforeACopyAreNotTriedAgain) {
  VismapConfig config;
  config.grid.voxel_size_m = 0.03;
  config.integration.max_frame_blocks = 1300;
  DeriveOptions(&config);
  const auto source = LogSource::Open(kLog, config);
  ASSERT_TRUE(source) << source.error().message;
  (*source)->Start();
  while (!(*source)->recording().state().done)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const int64_t mapped = (*source)->recording().state().mapped;
  ASSERT_GT(mapped, 18);
  ASSERT_LT(mapped, 40) << "some must be refused";
  MomentMaps maps(source->get());
  for (const int64_t frames : {int64_t{17}, mapped - 1}) {
    const std::shared_ptr<const LoadedMap> map = WaitFor(&maps, frames);
    ASSERT_NE(map, nullptr) << frames;
    EXPECT_EQ(HashMap(map->map), OfflineHash(config, frames)) << frames;
  }
}

TEST(MomentMaps, EndsWhileItComputes) {
  VismapConfig config;
  config.grid.voxel_size_m = 0.03;
  DeriveOptions(&config);
  const auto source = LogSource::Open(kLog, config);
  ASSERT_TRUE(source);
  (*source)->Start();
  while (!(*source)->recording().state().done)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const double begin = MonotonicSeconds();
  {
    MomentMaps maps(source->get());
    EXPECT_EQ(maps.Get(31), nullptr);
  }
  EXPECT_LT(MonotonicSeconds() - begin, 20);
}

}  // namespace
}  // namespace vismap
