#include "map_server/shared_trajectory.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

TEST(SharedTrajectory, FollowsAndItsCopiesStayAsTheyWere) {
  std::vector<CameraPose> trajectory;
  SharedTrajectory shared;
  std::vector<SharedTrajectory> copies;
  std::vector<size_t> sizes;
  const auto expect_first = [&](const SharedTrajectory& of, size_t size) {
    const std::vector<CameraPose> poses = of.Collect();
    ASSERT_EQ(of.size(), size);
    ASSERT_EQ(poses.size(), size);
    for (size_t i = 0; i < size; ++i) EXPECT_EQ(poses[i].utime, trajectory[i].utime);
  };
  for (const size_t more : {0, 1, 254, 1, 1, 255, 1000}) {
    for (size_t i = 0; i < more; ++i)
      trajectory.push_back({static_cast<int64_t>(trajectory.size()), CameraId{1}});
    shared.Follow(trajectory);
    copies.push_back(shared);
    sizes.push_back(trajectory.size());
    expect_first(shared, trajectory.size());
  }
  for (size_t i = 0; i < copies.size(); ++i) expect_first(copies[i], sizes[i]);
}

}  // namespace
}  // namespace vismap
