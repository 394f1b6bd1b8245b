#include "adapter/robot_bus.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace vismap {
namespace {

TEST(OpenWithin, TriesUntilItSucceedsOrTheTimeIsOver) {
  const StopSignal stop;
  int tries = 0;
  const auto third = [&]() -> Result<int> {
    if (++tries < 3) return Fail("not yet");
    return 7;
  };
  EXPECT_EQ(OpenWithin(10, stop, third), 7);
  EXPECT_EQ(tries, 3);
  const Result<int> never = OpenWithin(0.25, stop, []() -> Result<int> { return Fail("no hub"); });
  ASSERT_FALSE(never);
  EXPECT_EQ(never.error().message, "no hub");
}

TEST(OpenWithin, EndsWhenStopIsRequested) {
  StopSignal stop;
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop.Request();
  });
  const double start = MonotonicSeconds();
  EXPECT_FALSE(OpenWithin(60, stop, []() -> Result<int> { return Fail("no hub"); }));
  EXPECT_LT(MonotonicSeconds() - start, 30);
  later.join();
}

}  // namespace
}  // namespace vismap
