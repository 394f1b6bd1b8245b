#include "runtime/status.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>
#include <vismap/process_status_t.hpp>

#include "runtime/bus.h"

namespace vismap {
namespace {

TEST(StatusFindings, AreBoundedAndSayHowManyAreLeftOut) {
  auto bus = Bus::Open({"memq://", "tester", 1, nullptr});
  ASSERT_TRUE(bus) << bus.error().message;
  const auto publish = [&](Status* status) {
    status->Publish();
    while ((*bus)->Spin(0.01)) {
    }
  };
  Status status(bus->get(), "depth-segmenter");
  std::vector<std::string> found;
  (*bus)->Subscribe<process_status_t>(
      kStatusChannel, [&](const process_status_t& message) { found = message.findings; });
  for (int i = 0; i < 1000; ++i) {
    const std::string number = std::to_string(i);
    status.SetFinding("camera " + number, "camera " + number + " is shared");
    if (i == 15) {
      publish(&status);
      EXPECT_EQ(found.size(), 16u);
    }
  }
  EXPECT_EQ(status.findings().size(), 65u);
  publish(&status);
  ASSERT_EQ(found.size(), 16u);
  EXPECT_EQ(found.back(), "there are 50 more findings; the log of this process has them");
}

TEST(StatusTimings, SayMedianAndMaximumSinceTheLastStatusAndPercentilesOfTheLastMinute) {
  auto bus = Bus::Open({"memq://", "tester", 1, nullptr});
  ASSERT_TRUE(bus) << bus.error().message;
  Status status(bus->get(), "map-server");
  process_status_t found{};
  (*bus)->Subscribe<process_status_t>(kStatusChannel,
                                      [&](const process_status_t& message) { found = message; });
  const auto publish = [&] {
    status.Publish();
    while ((*bus)->Spin(0.01)) {
    }
  };
  const auto counter = [&](const std::string& name) {
    for (size_t i = 0; i < found.counter_names.size(); ++i) {
      if (found.counter_names[i] == name) return found.counter_values[i];
    }
    return int64_t{-1};
  };
  for (int i = 1; i <= 100; ++i) status.AddTiming("meshing", i);
  publish();
  EXPECT_EQ(found.timing_names, std::vector<std::string>{"meshing"});
  EXPECT_EQ(found.max_ms, std::vector<double>{100});
  EXPECT_EQ(counter("p50_us.meshing"), 50000);
  EXPECT_EQ(counter("p95_us.meshing"), 95000);
  publish();
  EXPECT_TRUE(found.timing_names.empty()) << "there was no other";
  EXPECT_EQ(counter("p95_us.meshing"), 95000);
  for (int i = 0; i < 1900; ++i) status.AddTiming("meshing", 1);
  publish();
  EXPECT_EQ(counter("p50_us.meshing"), 1000);
  EXPECT_EQ(counter("p95_us.meshing"), 1000);
  EXPECT_EQ(counter("p50_us.objects"), -1);
}

}  // namespace
}  // namespace vismap
