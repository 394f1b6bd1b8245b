#include "objects/find_up.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "objects/camera_up.h"

namespace vismap {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::Not;

// Points on the rectangle at `corner` with the edges `a` and `b` [m], 4 cm apart.
LabelSurface Rectangle(const Vector3d& corner, const Vector3d& a, const Vector3d& b) {
  LabelSurface surface;
  const auto steps = [](const Vector3d& edge) { return static_cast<int>(edge.norm() / 0.04); };
  for (int i = 0; i <= steps(a); ++i) {
    for (int j = 0; j <= steps(b); ++j) {
      const Vector3d p = corner + a * i / steps(a) + b * j / steps(b);
      surface.points_W.push_back(p.cast<float>());
    }
  }
  surface.vertices = std::ssize(surface.points_W);
  surface.area = a.cross(b).norm();
  return surface;
}

// A box as a camera before and above it sees it: front, side and top are one segment.
LabelSurface Box(const Vector3d& corner, const Vector3d& size) {
  const Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  LabelSurface box = Rectangle(corner, y, z);
  for (const LabelSurface& face : {Rectangle(corner, x, z), Rectangle(corner + z, x, y)}) {
    box.points_W.insert(box.points_W.end(), face.points_W.begin(), face.points_W.end());
    box.area += face.area;
  }
  box.vertices = std::ssize(box.points_W);
  return box;
}

// Floor at z = 0, walls at x = 2 and y = 1.5, two boxes on the floor, one of them at a wall, and a
// shelf on the other wall.
LabelSurfaces Room() {
  return {{},
          Rectangle({-1, -1.5, 0}, {3, 0, 0}, {0, 3, 0}),
          Rectangle({2, -1.5, 0}, {0, 3, 0}, {0, 0, 2}),
          Rectangle({-1, 1.5, 0}, {3, 0, 0}, {0, 0, 2}),
          Box({0.8, -0.2, 0}, {0.4, 0.5, 0.6}),
          Box({0.3, 1.1, 0}, {0.5, 0.4, 1.0}),
          Box({1.7, -1, 0.9}, {0.3, 0.6, 0.2})};
}

// A camera that walks along y 1.3 m above the floor and looks along x, a little down, rolled by
// `roll` [degrees] about its view.
std::vector<CameraPose> Walk(double roll) {
  std::vector<CameraPose> trajectory;
  for (int i = 0; i < 12; ++i) {
    CameraPose pose;
    Eigen::Matrix3d level;
    level.col(2) = Vector3d(1, 0.1 * std::sin(i), -0.25).normalized();
    level.col(0) = level.col(2).cross(Vector3d::UnitZ()).normalized();
    level.col(1) = level.col(2).cross(level.col(0));
    pose.T_W_C.linear() =
        level *
        Eigen::AngleAxisd(roll * std::numbers::pi / 180, Vector3d::UnitZ()).toRotationMatrix();
    pose.T_W_C.translation() = Vector3d(-1.3 + 0.02 * i, -0.5 + 0.1 * i, 1.3 + 0.05 * std::cos(i));
    trajectory.push_back(pose);
  }
  return trajectory;
}

ObjectOptions OptionsFor(const std::vector<CameraPose>& trajectory) {
  ObjectOptions options;
  options.cameras = UpOfCameras(trajectory);
  options.up_W = options.cameras.up_W;
  options.up_is_guess = true;
  return options;
}

TEST(FindUp, IsThatOfTheConfigWhenItIsGiven) {
  ObjectOptions options = OptionsFor(Walk(0));
  options.up_W = Vector3d::UnitY();
  options.up_is_guess = false;
  const UpDirection up = FindUp(options, Room());
  EXPECT_EQ(up.up_W, Vector3d::UnitY());
  EXPECT_THAT(up.reason, HasSubstr("config"));
}

TEST(FindUp, ALevelCameraIsBelieved) {
  const UpDirection up = FindUp(OptionsFor(Walk(0)), Room());
  EXPECT_EQ(up.up_W, Vector3d::UnitZ());
  EXPECT_THAT(up.reason, Not(HasSubstr("rolled")));
}

TEST(FindUp, WhatStandsOnTheFloorOutvotesARolledCamera) {
  for (const double roll : {90.0, -90.0, 180.0, 80.0, 105.0, -97.0}) {
    const UpDirection up = FindUp(OptionsFor(Walk(roll)), Room());
    EXPECT_EQ(up.up_W, Vector3d::UnitZ()) << roll << ": " << up.reason;
    EXPECT_THAT(up.reason, HasSubstr("rolled")) << roll;
  }
}

TEST(FindUp, WithoutThingsTheCameraIsBelieved) {
  LabelSurfaces empty = Room();
  empty.resize(4);
  EXPECT_NEAR(FindUp(OptionsFor(Walk(90)), empty).up_W.z(), 0, 1e-9);
}

// What hangs on a wall must not make it the floor.
TEST(FindUp, CupboardsOnAWallDoNotOutvoteALevelCamera) {
  LabelSurfaces kitchen{{},
                        Rectangle({2, -1.5, 0}, {0, 3, 0}, {0, 0, 2}),
                        Box({1.6, -1.4, 1.2}, {0.4, 0.8, 0.7}),
                        Box({1.6, -0.5, 1.2}, {0.4, 0.8, 0.7}),
                        Box({1.6, 0.4, 1.2}, {0.4, 0.8, 0.7})};
  EXPECT_EQ(FindUp(OptionsFor(Walk(0)), kitchen).up_W, Vector3d::UnitZ());
  kitchen[1] = Rectangle({-1, 1.5, 0}, {3, 0, 0}, {0, 0, 2});  // a wall beside the camera
  kitchen[2] = Box({-0.8, 1.1, 1.2}, {0.8, 0.4, 0.7});
  kitchen[3] = Box({0.1, 1.1, 1.2}, {0.8, 0.4, 0.7});
  kitchen[4] = Box({1.0, 1.1, 1.2}, {0.8, 0.4, 0.7});
  EXPECT_EQ(FindUp(OptionsFor(Walk(0)), kitchen).up_W, Vector3d::UnitZ());
}

// A ceiling with lamps, seen by a camera that looks up, is not the floor.
TEST(FindUp, LampsDoNotTurnTheRoomOver) {
  const LabelSurfaces ceiling{{},
                              Rectangle({-1, -1.5, 2.5}, {3, 0, 0}, {0, 3, 0}),
                              Box({0, 0, 2.2}, {0.3, 0.3, 0.3}),
                              Box({1, 0, 2.2}, {0.3, 0.3, 0.3})};
  std::vector<CameraPose> trajectory = Walk(0);
  for (CameraPose& pose : trajectory) {
    pose.T_W_C.linear() =
        Eigen::AngleAxisd(-0.6, Vector3d::UnitY()).toRotationMatrix() * pose.T_W_C.linear();
  }
  EXPECT_EQ(FindUp(OptionsFor(trajectory), ceiling).up_W, Vector3d::UnitZ());
}

}  // namespace
}  // namespace vismap
