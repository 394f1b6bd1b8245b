#include "runtime/recent_timings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/random_scenes.h"

namespace vismap {
namespace {

TEST(RecentTimings, PercentilesAreThoseOfTheSortedDurations) {
  testing_support::RandomNumbers random(3);
  for (const size_t count : {1, 2, 3, 19, 20, 21, 100, 101, 999}) {
    RecentTimings timings;
    std::vector<double> sorted;
    for (size_t i = 0; i < count; ++i) {
      sorted.push_back(random.Real(0, 100));
      timings.Add(sorted.back(), 0.01 * static_cast<double>(i));
    }
    std::sort(sorted.begin(), sorted.end());
    const auto found = timings.At(10);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->p50, sorted[(count + 1) / 2 - 1]) << count;
    EXPECT_EQ(found->p95, sorted[(95 * count + 99) / 100 - 1]) << count;
  }
}

TEST(RecentTimings, OnlyTheLastMinuteCounts) {
  RecentTimings timings;
  EXPECT_FALSE(timings.At(0));
  timings.Add(500, 1);
  timings.Add(3, 40);
  EXPECT_EQ(timings.At(61)->p95, 500);
  EXPECT_EQ(timings.At(61.1)->p95, 3);
  EXPECT_EQ(timings.At(61.1)->p50, 3);
  EXPECT_FALSE(timings.At(101));
}

TEST(RecentTimings, KeepsTheNewestOnes) {
  RecentTimings timings;
  for (size_t i = 0; i < RecentTimings::kMost; ++i) timings.Add(9, 0);
  for (size_t i = 0; i < RecentTimings::kMost; ++i) timings.Add(1, 1);
  EXPECT_EQ(timings.At(2)->p95, 1);
}

}  // namespace
}  // namespace vismap
