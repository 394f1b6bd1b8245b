#include "simulation/seen_surface.h"

#include <gtest/gtest.h>

#include "simulation/camera_path.h"
#include "simulation/room.h"

namespace vismap {
namespace {

TEST(SeenSurface, HoldsWhatCamerasSawAndNothingElse) {
  const Scene room = MakeRoom();
  FrameHeader header;
  header.camera = {160, 120, 131, 131, 79.5, 59.5};
  header.T_W_C = LookAt({0, 0, 1.5}, {2.5, 0, 1.4});
  SeenSurface seen;
  seen.AddView(header, Render(room, header.camera, header.T_W_C));
  EXPECT_TRUE(seen.IsSeen({2.5, 0, 1.4}));    // the wall before the camera
  EXPECT_FALSE(seen.IsSeen({-2.5, 0, 1.4}));  // the one behind it
  EXPECT_FALSE(seen.IsSeen({1, 0, 1.46}));    // in the air
  const LabelledMesh mesh = seen.Triangles(room, 0.05);
  EXPECT_GT(mesh.triangles.size(), 100u);
  for (const Eigen::Vector3d& p_W : mesh.points_W) EXPECT_GT(p_W.x(), 0);
  for (const auto& [id, frames] : seen.frames_of_object()) EXPECT_LE(frames, 1);
}

TEST(SeenSurface, GrowsWithTheTour) {
  const SeenSurface few = RenderSeenSurface({.frames = 3, .width = 80});
  const SeenSurface many = RenderSeenSurface({.frames = 12, .width = 80});
  const Scene room = MakeRoom();
  EXPECT_GT(many.Triangles(room, 0.1).points_W.size(), few.Triangles(room, 0.1).points_W.size());
}

}  // namespace
}  // namespace vismap
