#include "geometry/camera.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

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

TEST(ValidateCamera, RefusesAnglesOfViewThatNoCameraHas) {
  const auto problem = [](double fx, double cx) {
    const auto checked = ValidateCamera({640, 480, fx, 520, cx, 239.5});
    return checked ? std::string() : checked.error().message;
  };
  for (const double fx : {5.0, 0.82, 80.0, 1e-300})
    EXPECT_NE(problem(fx, 319.5).find("75 degrees"), std::string::npos) << fx;
  for (const double fx : {90.0, 300.0, 525.0, 50000.0}) EXPECT_EQ(problem(fx, 319.5), "") << fx;
  for (const double fx : {1e6, 1e9, 1e300})
    EXPECT_NE(problem(fx, 319.5).find("1000 times"), std::string::npos) << fx;
  for (const double fx : {0.0, -525.0, std::numeric_limits<double>::infinity()})
    EXPECT_NE(problem(fx, 319.5).find("positive"), std::string::npos) << fx;
  for (const double cx : {-3000.0, 3000.0, 1e12})
    EXPECT_NE(problem(525, cx).find("75 degrees"), std::string::npos) << cx;
  EXPECT_EQ(problem(525, -200), "");  // an image that was cut out of a larger one
}

TEST(ValidateCamera, RefusesMorePixelsThanAreEverDecoded) {
  EXPECT_TRUE(ValidateCamera({4096, 4096, 4000, 4000, 2048, 2048}));
  const auto refused = ValidateCamera({16384, 16384, 16000, 16000, 8192, 8192});
  EXPECT_NE(refused.error().message.find("16777216 in all"), std::string::npos);
}

}  // namespace
}  // namespace vismap
