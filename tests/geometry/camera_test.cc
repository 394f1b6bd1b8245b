#include "geometry/camera.h"

#include <gtest/gtest.h>

#include <limits>

namespace vismap {
namespace {

constexpr PinholeCamera kCamera{640, 480, 525, 520, 319.5, 239.5};

TEST(PinholeCamera, ProjectsBackProjectedPixelsToThemselves) {
  const Eigen::Vector3d p_C = kCamera.BackProject(100, 400, 2.5);
  EXPECT_DOUBLE_EQ(p_C.z(), 2.5);
  EXPECT_LT(p_C.x(), 0);  // left of the principal point
  EXPECT_GT(p_C.y(), 0);  // below it
  EXPECT_LT((kCamera.Project(p_C) - Eigen::Vector2d(100, 400)).norm(), 1e-9);
}

TEST(ValidateCamera, NamesTheFieldThatIsWrong) {
  EXPECT_TRUE(ValidateCamera(kCamera));
  const auto problem = [](PinholeCamera camera) { return ValidateCamera(camera).error().message; };
  PinholeCamera camera = kCamera;
  camera.height = 0;
  EXPECT_NE(problem(camera).find("size is 640x0"), std::string::npos);
  camera = kCamera;
  camera.fy = -520;
  EXPECT_NE(problem(camera).find("fy -520"), std::string::npos);
  camera = kCamera;
  camera.cx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(problem(camera).find("principal point"), std::string::npos);
}

}  // namespace
}  // namespace vismap
