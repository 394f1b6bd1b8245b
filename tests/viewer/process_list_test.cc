#include "viewer/process_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

void Count(const std::string& name, int64_t value, process_status_t* status) {
  status->counter_names.push_back(name);
  status->counter_values.push_back(value);
  status->n_counters = static_cast<int32_t>(status->counter_names.size());
}

TEST(MemoryLayers, AreTheCountersOfMemory) {
  process_status_t status{};
  EXPECT_THAT(MemoryLayers(status), IsEmpty());
  Count("memory.free_space_bytes", 7, &status);
  Count("memory._bytes", 1, &status);
  Count("memory.labels", 2, &status);
  Count("map_bytes", 3, &status);
  Count("memory.labels_bytes", 5, &status);
  EXPECT_THAT(MemoryLayers(status), ElementsAre(Pair("free_space", 7), Pair("labels", 5)));
}

TEST(ProcessList, PercentilesStandWithTheTimingsAndNotWithTheCounters) {
  process_status_t status{};
  status.source = "map-server";
  status.timing_names = {"meshing"};
  status.median_ms = {3};
  status.max_ms = {9};
  status.n_timings = 1;
  Count("frames", 5, &status);
  Count("p50_us.meshing", 4500, &status);
  Count("p95_us.meshing", 8000, &status);
  Count("p95_us.objects", 70000, &status);
  ProcessList list;
  list.Add(status, 0);
  status.utime = 1000000;
  status.counter_values = {8, 4600, 9000, 80000};
  list.Add(status, 1);
  const auto json = nlohmann::json::parse(list.Text(1, 0))["processes"][0];
  EXPECT_EQ(json["counters"], (nlohmann::json{{"frames", 8}}));
  EXPECT_EQ(json["rates"], (nlohmann::json{{"frames", 3.0}}));
  EXPECT_EQ(
      json["timings"]["meshing"],
      (nlohmann::json{{"median_ms", 3.0}, {"max_ms", 9.0}, {"p50_ms", 4.6}, {"p95_ms", 9.0}}));
  EXPECT_EQ(json["timings"]["objects"], (nlohmann::json{{"p95_ms", 80.0}}));
}

}  // namespace
}  // namespace vismap
