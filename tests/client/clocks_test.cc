#include "client/clocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "runtime/clock.h"

namespace vismap {
namespace {

constexpr double kWall = 1.7e9;  // by how much the wall clock is ahead of the steady one [s]

/// A camera of 30 Hz with jitter of the arrival; `error` is that of the time found for a frame.
class ClockRun {
 public:
  explicit ClockRun(DeviceClock* clock) : clock_(*clock) {}

  void Frame(double taken_s, double device_s) {
    const double arrival = taken_s + 0.002 + jitter_(random_);
    const auto wall = static_cast<int64_t>(std::llround((arrival + kWall + wall_step_s) * 1e6));
    const int64_t utime = clock_.ToUtime(device_s, wall, 20 + arrival);
    times.push_back(utime);
    errors.push_back(static_cast<double>(utime) * 1e-6 - (taken_s + kWall + wall_step_s));
  }
  double WorstFrom(size_t first) const {
    double worst = 0;
    for (size_t i = first; i < errors.size(); ++i) worst = std::max(worst, std::abs(errors[i]));
    return worst;
  }

  double wall_step_s = 0;
  std::vector<int64_t> times;
  std::vector<double> errors;

 private:
  DeviceClock& clock_;
  std::mt19937 random_{3};
  std::exponential_distribution<double> jitter_{1 / 0.003};
};

TEST(DeviceClock, JitterDisappearsAndDriftIsFollowed) {
  DeviceClock steady(30, 0.002), drifting(5);
  ClockRun run(&steady), drift(&drifting);
  for (int i = 0; i < 3000; ++i) {
    run.Frame(i / 30.0, 100 + i / 30.0);
    drift.Frame(i / 30.0, i / 30.0 * 1.0001);
  }
  EXPECT_LT(run.WorstFrom(100), 0.0005);
  EXPECT_LT(drift.WorstFrom(200), 0.004);
  EXPECT_EQ(drifting.restarts() + drifting.steps_back(), 0);
}

TEST(DeviceClock, AWallClockThatIsSetCountsAtOnce) {
  for (const double step : {-3600.0, -5.0, -0.2, 0.3, 5.0, 3600.0}) {
    DeviceClock clock;
    ClockRun run(&clock);
    for (int i = 0; i < 600; ++i) {
      if (i == 300) run.wall_step_s = step;
      run.Frame(i / 30.0, 50 + i / 30.0);
    }
    EXPECT_LT(run.WorstFrom(200), 0.003) << step;
    EXPECT_EQ(clock.steps_back(), step < 0 ? 1 : 0) << step;
    for (size_t i = 1; i < run.times.size(); ++i)
      EXPECT_EQ(run.times[i] <= run.times[i - 1], step < 0 && i == 300) << step << " " << i;
  }
}

TEST(DeviceClock, ARestartedCameraIsFollowedAndTimesStillIncrease) {
  DeviceClock clock;
  ClockRun run(&clock);
  for (int i = 0; i < 600; ++i) run.Frame(i / 30.0, i < 300 ? 70 + i / 30.0 : (i - 300) / 30.0);
  EXPECT_EQ(clock.restarts(), 1);
  EXPECT_LT(run.WorstFrom(400), 0.003);
  EXPECT_TRUE(std::is_sorted(run.times.begin(), run.times.end()));
  EXPECT_EQ(std::adjacent_find(run.times.begin(), run.times.end()), run.times.end());
  for (int i = 0; i < 5; ++i)
    EXPECT_GT(run.times.back() + i + 2, clock.ToUtime(10, run.times.back() - i, 40.0));
}

TEST(DeviceClock, ReadsTheClocksOfTheComputerAndRefusesWhatIsNoTime) {
  DeviceClock clock;
  EXPECT_NEAR(static_cast<double>(clock.ToUtime(3) - WallUtime()), 0, 1e6);
  EXPECT_THROW(clock.ToUtime(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  EXPECT_THROW(clock.ToUtime(std::numeric_limits<double>::infinity()), std::invalid_argument);
}

TEST(FramePace, IsEven) {
  for (const auto& [rate, expected] :
       {std::pair(10.0, 10.0), std::pair(30.0, 30.0), std::pair(100.0, 30.0), std::pair(15.0, 15.0),
        std::pair(0.0, 30.0)}) {
    FramePace pace(rate);
    std::mt19937 random(9);
    std::vector<int> taken;
    for (int i = 0; i < 300; ++i) {
      const int jitter = std::uniform_int_distribution(-2000, 2000)(random);
      if (pace.Takes(std::llround(i / 30.0 * 1e6) + jitter)) taken.push_back(i);
    }
    EXPECT_NEAR(static_cast<double>(taken.size()) / 10, expected, 0.5);
    for (size_t i = 1; i < taken.size(); ++i) EXPECT_LE(taken[i] - taken[i - 1], 30 / expected);
  }
  FramePace pace(10);
  EXPECT_TRUE(pace.Takes(10000000));
  EXPECT_FALSE(pace.Takes(10030000));
  EXPECT_TRUE(pace.Takes(1000000)) << "the clock was set back";
}

TEST(NewestValue, ReplacesOthersAndCountsThem) {
  NewestValue<int> newest;
  EXPECT_EQ(newest.Take(0.001), std::nullopt);
  newest.Put(1);
  newest.Put(2);
  EXPECT_EQ(newest.Take(1), 2);
  EXPECT_EQ(newest.skipped(), 1);
  std::thread other([&] { newest.Put(3); });
  EXPECT_EQ(newest.Take(10), 3);
  other.join();
  EXPECT_EQ(newest.Take(0), std::nullopt);
}

}  // namespace
}  // namespace vismap
