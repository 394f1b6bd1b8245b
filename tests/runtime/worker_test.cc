#include "runtime/worker.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "runtime/clock.h"

namespace vismap {
namespace {

class Working : public ::testing::Test {
 protected:
  void SpinUntil(const std::function<bool()>& reached) {
    const double deadline = MonotonicSeconds() + 10;
    while (!reached() && MonotonicSeconds() < deadline) bus_->Spin(5);
    EXPECT_TRUE(reached());
  }

  std::unique_ptr<Bus> bus_ = std::move(*Bus::Open({"memq://", "test"}));
};

TEST_F(Working, DoesWorkInAnotherThreadAndTellsInThatOfTheBus) {
  Worker worker(bus_.get());
  const auto here = std::this_thread::get_id();
  std::vector<std::string> told;
  for (const std::string name : {"a", "b", "c"}) {
    worker.Start(
        [&, name] {
          EXPECT_NE(std::this_thread::get_id(), here);
          worker.Post([&, name] { told.push_back("on the way to " + name); });
          return name;
        },
        [&](const std::string& done) {
          EXPECT_EQ(std::this_thread::get_id(), here);
          told.push_back(done);
        });
  }
  const double start = MonotonicSeconds();
  SpinUntil([&] { return told.size() == 6; });
  EXPECT_LT(MonotonicSeconds() - start, 4) << "Spin wakes up when work is done";
  EXPECT_EQ(told, (std::vector<std::string>{"on the way to a", "a", "on the way to b", "b",
                                            "on the way to c", "c"}));
}

TEST_F(Working, TheBusGoesOnMeanwhile) {
  Worker worker(bus_.get());
  std::atomic<bool> may_end = false, ended = false;
  worker.Start(
      [&] {
        while (!may_end) std::this_thread::yield();
        return 1;
      },
      [&](int) { ended = true; });
  int ticks = 0;
  bus_->Every(0.001, [&] { ++ticks; });
  SpinUntil([&] { return ticks >= 5; });
  EXPECT_FALSE(ended);
  may_end = true;
  SpinUntil([&] { return ended.load(); });
}

TEST_F(Working, FinishWaitsForAllAndTheEndOnlyForWhatHasBegun) {
  int done = 0;
  {
    Worker worker(bus_.get());
    for (int i = 0; i < 20; ++i) worker.Start([i] { return i; }, [&](int) { ++done; });
    worker.Finish();
    EXPECT_EQ(done, 20);
    worker.Finish();
    std::atomic<bool> begun = false;
    worker.Start(
        [&] {
          begun = true;
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
          return 0;
        },
        [&](int) { ++done; });
    while (!begun) std::this_thread::yield();
    worker.Start([] { return 0; }, [&](int) { ++done; });
  }
  EXPECT_EQ(done, 20) << "nothing is told after the end";
}

TEST_F(Working, AnExceptionLeavesSpin) {
  Worker worker(bus_.get());
  bool told = false;
  worker.Start([]() -> int { throw std::runtime_error("no"); }, [&](int) { told = true; });
  EXPECT_THROW(SpinUntil([] { return false; }), std::runtime_error);
  EXPECT_FALSE(told);
}

}  // namespace
}  // namespace vismap
