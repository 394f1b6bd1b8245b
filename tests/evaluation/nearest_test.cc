#include "evaluation/nearest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace vismap {
namespace {

TEST(NearestPoints, AreThoseOfBruteForceWithTiesToTheLowerIndex) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> coordinate(0, 6);  // a coarse grid: many ties and doubles
  const auto point = [&] {
    return Eigen::Vector3d(coordinate(random), coordinate(random), coordinate(random));
  };
  std::vector<Eigen::Vector3d> points(500);
  for (Eigen::Vector3d& p : points) p = point();
  const NearestPoints tree(points);
  for (int query = 0; query < 200; ++query) {
    const Eigen::Vector3d p = point() + Eigen::Vector3d(query % 2 * 0.5, 0, 0);
    std::vector<std::pair<double, size_t>> all;
    for (size_t i = 0; i < points.size(); ++i) all.emplace_back((points[i] - p).norm(), i);
    std::sort(all.begin(), all.end());
    const std::vector<Neighbour> found = tree.Nearest(p, 12);
    ASSERT_EQ(found.size(), 12u);
    for (size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].index, all[i].second);
      EXPECT_NEAR(found[i].distance, all[i].first, 1e-12);
    }
  }
}

TEST(NearestPoints, OfFewPointsAreFew) {
  EXPECT_FALSE(NearestPoints({}).Nearest({0, 0, 0}));
  EXPECT_EQ(NearestPoints({{1, 0, 0}, {2, 0, 0}}).Nearest({0, 0, 0}, 12).size(), 2u);
}

}  // namespace
}  // namespace vismap
