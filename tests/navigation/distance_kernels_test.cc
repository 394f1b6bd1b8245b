#include "navigation/distance_kernels.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "navigation/naive_distances.h"
#include "navigation/random_leaves.h"

namespace vismap {
namespace {

using testing_support::NaiveAnyNear;
using testing_support::NaiveLeast;
using testing_support::NaiveSquare;
using testing_support::Random;

uint16_t RandomSquare(Random* random, int most) {
  return random->Below(4) == 0 ? kBeyond : static_cast<uint16_t>(random->Below(most));
}

std::vector<uint16_t> Costs(int count) {
  std::vector<uint16_t> cost;
  for (int d = 0; d < count; ++d) cost.push_back(NaiveSquare(static_cast<uint8_t>(d)));
  return cost;
}

TEST(DistanceKernels, LeastAlongLineEqualsTheNaiveOne) {
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    const int window = 1 + random.Below(90);
    const ptrdiff_t stride = random.Below(2) == 0 ? 8 : 64;
    const std::vector<uint16_t> cost = Costs(window + 1);
    const auto most = static_cast<uint16_t>(cost.back() + random.Below(100));
    std::vector<uint16_t> in(64 + 2 * static_cast<size_t>(window * stride));
    const int scale = 1 + random.Below(most);
    for (uint16_t& value : in) value = RandomSquare(&random, scale);
    const uint16_t* first = in.data() + window * stride;
    std::array<uint16_t, 64> out;
    LeastAlongLine(first, stride, window, cost.data(), most, out.data());
    for (size_t i = 0; i < out.size(); ++i)
      ASSERT_EQ(out[i], NaiveLeast(first + i, stride, window, cost.data(), most)) << round;
  }
}

TEST(DistanceKernels, SquareRowDistancesEqualsTheNaiveOne) {
  std::array<uint8_t, 64> leaves;
  std::array<uint16_t, 64> squared;
  for (size_t i = 0; i < 64; ++i) leaves[i] = static_cast<uint8_t>(i < 60 ? i : i + 27);
  leaves[63] = kNoneInRow;
  SquareRowDistances(leaves.data(), squared.data());
  for (size_t i = 0; i < 64; ++i) EXPECT_EQ(squared[i], NaiveSquare(leaves[i])) << i;
}

TEST(DistanceKernels, AnyNearEqualsTheNaiveOne) {
  Random random(4);
  int near = 0;
  for (int round = 0; round < 500; ++round) {
    std::array<uint16_t, 64> least, cost, now;
    least.fill(kBeyond);
    cost.fill(static_cast<uint16_t>(random.Below(kBeyond + 1)));
    for (uint16_t& value : now) value = RandomSquare(&random, 3000);
    least[static_cast<size_t>(random.Below(64))] = RandomSquare(&random, 3000);
    bool expected = false;
    for (size_t i = 0; i < 64; ++i) expected |= NaiveAnyNear(least[i], cost[i], now[i], 2500);
    ASSERT_EQ(AnyNear(least.data(), cost.data(), now.data(), 2500), expected) << round;
    near += expected;
  }
  EXPECT_GT(near, 5);
  EXPECT_LT(near, 495);
}

}  // namespace
}  // namespace vismap
