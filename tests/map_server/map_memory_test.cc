#include "map_server/map_memory.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "map_server/live_map.h"
#include "segmentation/segment_frame.h"
#include "simulation/sequence.h"
#include "small_frames.h"

namespace vismap {
namespace {

using testing_support::MemoryBus;

size_t Total(const std::vector<MemoryLayer>& layers) {
  return std::accumulate(layers.begin(), layers.end(), size_t{0},
                         [](size_t sum, const MemoryLayer& layer) { return sum + layer.bytes; });
}

size_t BytesOf(const std::vector<MemoryLayer>& layers, const std::string& name) {
  for (const MemoryLayer& layer : layers) {
    if (layer.name == name) return layer.bytes;
  }
  ADD_FAILURE() << "there is no layer " << name;
  return 0;
}

/// What the allocator has handed out [bytes].
size_t Allocated() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

class MapMemory : public ::testing::Test {
 protected:
  /// Maps these frames of a room, and publishes surface and objects.
  void Map(const std::string& room, size_t from, size_t to) {
    const auto dataset = OpenSequence(room, "", {});
    ASSERT_TRUE(dataset) << dataset.error().message;
    for (size_t i = from; i < to; ++i) {
      const Result<SensorFrame> sensor = (*dataset)->Read(i);
      ASSERT_TRUE(sensor) << sensor.error().message;
      map_->Integrate(SegmentFrame(*DecodeFrame(*sensor), nullptr, {}));
    }
    map_->PublishAll();
    while (bus_->Spin(0)) {
    }
  }

  std::unique_ptr<Bus> bus_ = MemoryBus();
  Status status_{bus_.get(), "map-server"};
  std::unique_ptr<LiveMap> map_;
};

TEST_F(MapMemory, LayersAddUpToWhatTheAllocatorHolds) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer has an allocator of its own";
#endif
  const std::string room = "synthetic:room?frames=24&width=320";
  map_ = std::make_unique<LiveMap>(VismapConfig(), bus_.get(), &status_);
  // The first frames also allocate what threads keep for their work, which is no part of the map.
  Map(room, 0, 4);
  const size_t held_before = Allocated(), counted_before = Total(map_->Memory());
  Map(room, 4, 24);
  const auto held = static_cast<double>(Allocated() - held_before);
  const auto counted = static_cast<double>(Total(map_->Memory()) - counted_before);
  RecordProperty("held", std::to_string(held));
  RecordProperty("counted", std::to_string(counted));
  EXPECT_GT(held, 20e6);
  EXPECT_NEAR(counted, held, 0.2 * held) << ToJson(map_->Memory()).dump();
}

TEST_F(MapMemory, EveryLayerIsCounted) {
  map_ = std::make_unique<LiveMap>(VismapConfig(), bus_.get(), &status_);
  Map("synthetic:room?frames=3&width=160", 0, 3);
  const std::vector<MemoryLayer> layers = map_->Memory();
  for (const char* name : {"distances", "colours", "labels", "free_space", "table", "surface",
                           "occupancy", "objects", "trajectory"})
    EXPECT_GT(BytesOf(layers, name), 0u) << name;
  EXPECT_EQ(BytesOf(layers, "copies"), 0u);
  const auto copy = map_->Snapshot();
  EXPECT_GE(BytesOf(map_->Memory(), "copies"), BytesOf(layers, "table"));
  EXPECT_EQ(ToJson(layers)["labels"], BytesOf(layers, "labels"));
  map_->ReportMemoryIfDue();
  EXPECT_EQ(status_.counter("memory.table_bytes"), static_cast<int64_t>(BytesOf(layers, "table")));
  map_->Reset();
  for (const char* name : {"distances", "colours", "packed", "free_space", "objects", "trajectory"})
    EXPECT_EQ(BytesOf(map_->Memory(), name), 0u) << name;
}

}  // namespace
}  // namespace vismap
