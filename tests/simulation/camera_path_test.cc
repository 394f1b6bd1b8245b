#include "simulation/camera_path.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

using Eigen::Vector3d;

TEST(LookAt, PutsTheTargetInTheMiddleOfTheImage) {
  const Pose T_W_C = LookAt({1, 2, 3}, {2, 4, 1});
  const Vector3d target_C = T_W_C.inverse() * Vector3d(2, 4, 1);
  EXPECT_LT((target_C - Vector3d(0, 0, 3)).norm(), 1e-12);
  EXPECT_TRUE(MakePose(T_W_C.matrix()));
  EXPECT_THROW(LookAt({0, 0, 0}, {0, 0, 1}), std::logic_error);
}

TEST(CurveAt, GoesThroughItsPointsAndCloses) {
  const std::vector<Vector3d> points{{0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(CurveAt(points, static_cast<double>(i)), points[i]);
  }
  EXPECT_LT((CurveAt(points, 3.999999) - points[0]).norm(), 1e-5);
}

}  // namespace
}  // namespace vismap
