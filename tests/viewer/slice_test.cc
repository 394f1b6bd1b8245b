#include "viewer/slice.h"

#include <gmock/gmock.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "viewer/process_list.h"

namespace vismap {
namespace {

// Free but for one occupied voxel, at the given places.
OccupancyMap SomeSpace() {
  OccupancyMap map(0.05);
  map.Set({0, 0, 0}, BlockOccupancy(CellState::kFree));
  OccupancyPlanes planes;
  planes.free.fill(~uint64_t{0});
  planes.free[2] &= ~(uint64_t{1} << (3 + 8 * 5));  // voxel (3, 5, 2) of the block
  planes.occupied[2] |= uint64_t{1} << (3 + 8 * 5);
  map.Set({-1, 1, 0}, BlockOccupancy(planes));
  return map;
}

Slice Cut(const char* target, size_t max_cells = 1 << 20) {
  const auto question = ReadSlice(*ParseTarget(target));
  EXPECT_TRUE(question) << target;
  return *CutSlice(SomeSpace(), *question, max_cells);
}

TEST(Slice, EqualsTheVoxelsOfTheMap) {
  const OccupancyMap map = SomeSpace();
  for (const char* axis : {"x", "y", "z"}) {
    const Slice slice = Cut(("/api/slice?at=0.12&axis=" + std::string(axis)).c_str());
    ASSERT_EQ(slice.states.size(), static_cast<size_t>(slice.width * slice.height));
    EXPECT_EQ(slice.layer, 2);
    size_t compared = 0;
    for (int row = 0; row < slice.height; ++row) {
      for (int column = 0; column < slice.width; ++column) {
        const double u = slice.origin_m[0] + (column + 0.5) * slice.cell_m;
        const double v = slice.origin_m[1] + (row + 0.5) * slice.cell_m;
        const Eigen::Vector3d p_W = *axis == 'x'   ? Eigen::Vector3d(0.12, u, v)
                                    : *axis == 'y' ? Eigen::Vector3d(u, 0.12, v)
                                                   : Eigen::Vector3d(u, v, 0.12);
        EXPECT_EQ(slice.states[static_cast<size_t>(row * slice.width + column)],
                  static_cast<uint8_t>(map.At(p_W)));
        ++compared;
      }
    }
    EXPECT_GE(compared, 64u);
  }
}

TEST(Slice, LargeCellIsOccupiedWhenOneVoxelIsAndFreeWhenAllAre) {
  const Slice slice = Cut("/api/slice?axis=z&at=0.12&res=0.4");
  ASSERT_EQ(slice.width, 2);
  ASSERT_EQ(slice.height, 2);
  EXPECT_THAT(slice.states, testing::ElementsAre(0, 1, 2, 0));
  EXPECT_DOUBLE_EQ(slice.origin_m[0], -0.4);
}

TEST(Slice, CellsGrowUntilThePictureFits) {
  const Slice slice = Cut("/api/slice?axis=z&at=0.12", 70);
  EXPECT_LE(slice.states.size(), 70u);
  EXPECT_DOUBLE_EQ(slice.cell_m, 0.1);
}

TEST(Slice, OutsideAndEmptyMapsGiveUnknownOrNothing) {
  const Slice slice = Cut("/api/slice?axis=z&at=-99999");
  EXPECT_THAT(slice.states, testing::Each(0));
  EXPECT_TRUE(CutSlice(OccupancyMap(0.05), {})->states.empty());
}

TEST(Slice, LongSidesNeedLargerCells) {
  OccupancyMap map(0.05);
  map.Set({0, 0, 0}, BlockOccupancy(CellState::kFree));
  map.Set({1023, 0, 0}, BlockOccupancy(CellState::kFree));  // a side of 8192 voxels
  EXPECT_EQ(CutSlice(map, {2, 0, 0})->width, 4096);
  const auto refused = CutSlice(map, {2, 0, 0.05});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("res=0.1"));
  EXPECT_TRUE(CutSlice(map, {2, 0, 0.1}));
}

TEST(Slice, AtMostTenNewSlicesPerSecondAndTheLastOneIsKept) {
  const OccupancyMap map = SomeSpace();
  SliceAnswers answers;
  const auto status = [&](int layer, double now, int64_t revision = 7) {
    const std::string target = "/api/slice?at=" + std::to_string(0.05 * layer + 0.02);
    const auto found = answers.Find(*ReadSlice(*ParseTarget(target)), map, {"m", revision}, now);
    return found ? 200 : found.error().status;
  };
  for (int layer = 0; layer < 10; ++layer) EXPECT_EQ(status(layer, 100), 200);
  EXPECT_EQ(status(10, 100), 429);
  EXPECT_EQ(status(9, 100), 200) << "the last slice is kept";
  EXPECT_EQ(status(9, 100, 8), 429) << "of another revision";
  EXPECT_EQ(status(10, 100.11), 200);
  EXPECT_EQ(status(11, 100.11), 429);
}

TEST(Slice, AMapIsSoughtOnlyForASliceThatMayBeCut) {
  const OccupancyMap map = SomeSpace();
  SliceAnswers answers;
  int sought = 0;
  const auto ask = [&](int layer) {
    const SliceQuestion question{2, 0.05 * layer + 0.02, 0};
    const auto find = [&]() -> tl::expected<const OccupancyMap*, HttpAnswer> {
      ++sought;
      if (layer == 3) return tl::unexpected(ErrorAnswer(500, "it cannot be read"));
      return &map;
    };
    const auto found = answers.Find(question, map.cell_size(), find, {"m", 7}, 100);
    return found ? 200 : found.error().status;
  };
  for (int layer = 0; layer < 10; ++layer) EXPECT_EQ(ask(layer), layer == 3 ? 500 : 200);
  EXPECT_EQ(ask(9), 200) << "the last slice is kept";
  for (int layer = 10; layer < 30; ++layer) EXPECT_EQ(ask(layer), 429);
  EXPECT_EQ(sought, 10);
}

TEST(Slice, WrongArgumentsAreRefused) {
  for (const char* target :
       {"/api/slice", "/api/slice?at=x", "/api/slice?at=1&axis=w", "/api/slice?at=1&res=-1",
        "/api/slice?at=nan", "/api/slice?at=1e9", "/api/slice?at=1&distance=yes",
        "/api/slice?at=1&what=2", "/api/slice?at=1,2"})
    EXPECT_FALSE(ReadSlice(*ParseTarget(target))) << target;
}

TEST(Slice, EncodedAsJsonAndBytes) {
  const Slice slice = Cut("/api/slice?axis=z&at=0.12&res=0.4");
  const std::vector<uint8_t> bytes = EncodeSlice(slice, {2, 0.12, 0.4}, {"m", 7});
  uint32_t size = 0;
  std::memcpy(&size, bytes.data(), 4);
  EXPECT_EQ(size % 4, 0u);
  const auto json = nlohmann::json::parse(bytes.begin() + 4, bytes.begin() + 4 + size);
  EXPECT_EQ(json["revision"], 7);
  EXPECT_EQ(json["axes"], nlohmann::json({"x", "y"}));
  EXPECT_EQ(bytes.size(), 4 + size + 4);
}

process_status_t SomeStatus(int64_t utime, int64_t frames, int64_t start = 1) {
  process_status_t status{};
  status.utime = utime;
  status.source = status.process = "map-server";
  status.start_utime = start;
  status.state = "running";
  status.counter_names = {"frames"};
  status.counter_values = {frames};
  status.n_counters = 1;
  return status;
}

TEST(ProcessList, SaysRatesBetweenTwoStatuses) {
  ProcessList list;
  list.Add(SomeStatus(1000000, 10), 1);
  list.Add(SomeStatus(3000000, 50), 3);
  list.Add(SomeStatus(3010000, 50), 3.01);  // right after a change of state
  const auto json = nlohmann::json::parse(list.Text(4, 5));
  const auto& process = json["processes"][0];
  EXPECT_EQ(process["rates"]["frames"], 20);
  EXPECT_EQ(process["counters"]["frames"], 50);
  EXPECT_NEAR(process["age_s"].get<double>(), 0.99, 1e-6);
}

TEST(ProcessList, RestartHasNoRatesAndOldOnesAreForgotten) {
  ProcessList list;
  list.Add(SomeStatus(1000000, 10), 1);
  list.Add(SomeStatus(3000000, 50, 2), 3);
  EXPECT_TRUE(nlohmann::json::parse(list.Text(4, 5))["processes"][0]["rates"].empty());
  list.Text(3 + ProcessList::kForgetAfter + 1, 5);
  EXPECT_EQ(list.size(), 0u);
}

TEST(ProcessList, NumberOfProcessesIsBounded) {
  ProcessList list;
  for (int i = 0; i < 1000; ++i) {
    process_status_t status = SomeStatus(1, 1);
    status.source = "p" + std::to_string(i);
    list.Add(status, 1);
  }
  EXPECT_EQ(list.size(), ProcessList::kMost);
}

}  // namespace
}  // namespace vismap
