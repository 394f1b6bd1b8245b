#include "viewer/moment_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "runtime/clock.h"
#include "sequence_mapper/map_sequence.h"
#include "viewer/log_source.h"

namespace vismap {
namespace {

using testing::HasSubstr;

constexpr size_t kPlenty = size_t{1} << 30;
constexpr const char* kLog = "synthetic:room?frames=40&width=96";

Result<MomentMaps::MapPtr> WaitFor(MomentMaps* maps, int64_t frames) {
  const double end = MonotonicSeconds() + 60;
  Result<MomentMaps::MapPtr> map;
  while ((map = maps->Get(frames)) && *map == nullptr && MonotonicSeconds() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return map;
}

MomentMaps::MakeMap MakerOf(const LogSource& source) {
  return [&source](int64_t frames, const std::atomic<bool>* stop) {
    return source.MapAfter(frames, stop);
  };
}

// A recording of 100 frames with a copy of the map after the first one.
std::unique_ptr<LogRecording> DoneRecording() {
  auto recording = std::move(*LogRecording::Open("", kPlenty, "map-1"));
  auto map = std::make_shared<LoadedMap>(LoadedMap{SemanticMap(VoxelGridOptions{}), {}, ""});
  map->map.revision = 1;
  recording->AddCopy(1, map, {}, kPlenty);
  recording->SetState({100, 100, 100, true, ""});
  return recording;
}

Result<MomentMaps::MapPtr> MapOf(int64_t frames) {
  auto map = std::make_shared<LoadedMap>(LoadedMap{SemanticMap(VoxelGridOptions{}), {}, ""});
  map->map.revision = frames;
  map->map.labels.GrowLabels(SegmentLabel{10000});
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
  MomentMaps maps(&(*source)->recording(), MakerOf(**source), kPlenty);
  for (const int64_t frames : {37, 5, 32, 40, 37}) {
    const Result<MomentMaps::MapPtr> made = WaitFor(&maps, frames);
    ASSERT_TRUE(made && *made != nullptr) << frames;
    const MomentMaps::MapPtr map = *made;
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
  MomentMaps maps(&(*source)->recording(), MakerOf(**source), kPlenty);
  for (const int64_t frames : {int64_t{17}, mapped - 1}) {
    const Result<MomentMaps::MapPtr> made = WaitFor(&maps, frames);
    ASSERT_TRUE(made && *made != nullptr) << frames;
    const MomentMaps::MapPtr map = *made;
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
    MomentMaps maps(&(*source)->recording(), MakerOf(**source), kPlenty);
    EXPECT_EQ(*maps.Get(31), nullptr);
  }
  EXPECT_LT(MonotonicSeconds() - begin, 20);
}

TEST(MomentMaps, AMapThatCannotBeMadeIsAnErrorAndIsTriedOnce) {
  const auto recording = DoneRecording();
  std::atomic<int> tries = 0;
  const auto make = [&](int64_t frames, const std::atomic<bool>*) -> Result<MomentMaps::MapPtr> {
    ++tries;
    if (frames == 3) return Fail("the third frame is lost");
    if (frames == 4) throw std::runtime_error("out of luck");
    return MapOf(frames);
  };
  MomentMaps maps(recording.get(), make, kPlenty);
  for (int i = 0; i < 3; ++i) {
    const Result<MomentMaps::MapPtr> third = WaitFor(&maps, 3), fourth = WaitFor(&maps, 4);
    ASSERT_FALSE(third);
    EXPECT_EQ(third.error().message, "the third frame is lost");
    ASSERT_FALSE(fourth);
    EXPECT_THAT(fourth.error().message, HasSubstr("out of luck"));
  }
  EXPECT_EQ(tries, 2);
  EXPECT_EQ((*WaitFor(&maps, 5))->map.revision, 5) << "its thread goes on";
}

// Detections that cannot be read.
class BrokenDetections : public DetectionSource {
 public:
  Result<DetectionSet> ForFrame(const FrameHeader&) const override { return Fail("broken"); }
  int64_t size() const override { return -1; }
};

TEST(MomentMaps, AFewFramesMayAllBeWithoutDetections) {
  VismapConfig config;
  config.grid.voxel_size_m = 0.05;
  DeriveOptions(&config);
  const auto dataset = OpenSequence("synthetic:room?frames=2&width=96", "");
  ASSERT_TRUE(dataset);
  const BrokenDetections detections;
  OfflineInput input{**dataset, &detections};
  StageTimes times;
  for (const bool is_part : {false, true}) {
    MapSession session(config, {});
    input.is_part = is_part;
    const auto mapped = MapSequence(
        input, config, [](size_t) { return true; }, &session, &times);
    EXPECT_EQ(mapped.has_value(), is_part);
    EXPECT_EQ(session.map().revision, 2);
  }
}

TEST(MomentMaps, KeepsTheLastMapsWithinItsBytes) {
  const auto recording = DoneRecording();
  std::vector<int64_t> made;
  const auto make = [&](int64_t frames, const std::atomic<bool>*) {
    made.push_back(frames);
    return MapOf(frames);
  };
  const size_t bytes = BytesOf((*MapOf(9))->map);
  const std::vector<std::pair<size_t, std::vector<int64_t>>> cases{
      {10 * bytes, {5, 6, 7, 8, 5}},
      {2 * bytes + 10000, {5, 6, 7, 8, 6, 5}},
      {bytes / 2, {5, 6, 7, 8, 7, 6, 5}}};
  for (const auto& [most, expected] : cases) {
    made.clear();
    {
      MomentMaps maps(recording.get(), make, most);
      for (const int64_t frames : {5, 6, 7, 8, 8, 7, 6, 5})
        ASSERT_TRUE(WaitFor(&maps, frames)) << frames;
    }
    EXPECT_EQ(made, expected) << most;
  }
}

}  // namespace
}  // namespace vismap
