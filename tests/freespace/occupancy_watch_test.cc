#include "freespace/occupancy_watch.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "support/analytic_map.h"

namespace vismap {
namespace {

/// Changes random blocks of a map and returns these blocks.
std::vector<BlockIndex> TouchSome(std::mt19937& random, SemanticMap* map) {
  std::vector<BlockIndex> touched;
  for (const BlockIndex& index : map->voxels.SortedIndices()) {
    if (random() % 4 != 0) continue;
    touched.push_back(index);
    Block& block = *map->voxels.FindMutable(index);
    if (!block.surface || random() % 3 == 0) continue;
    for (uint8_t& seen : block.surface->observations) seen = random() % 2 == 0 ? 0 : 5;
    if (random() % 2 == 0) block.surface->observations.fill(0);
  }
  ++map->revision;
  return touched;
}

TEST(OccupancyWatch, TellsTheSameAsACopyOfTheOccupancy) {
  testing_support::AnalyticScene scene;
  scene.distance = [](const Eigen::Vector3d& p) {
    return testing_support::SphereDistance(p, {0, 0, 0}, 0.3);
  };
  SemanticMap map = testing_support::MakeAnalyticMap(
      scene, {Eigen::Array3d(-0.4, -0.4, -0.4), Eigen::Array3d(0.4, 0.4, 0.4), 5}, {0.02, 4});
  OccupancyMap copy(0.02);
  OccupancyWatch watch({});
  EXPECT_EQ(watch.Update(map, map.voxels.SortedIndices()),
            copy.Update(map, map.voxels.SortedIndices(), {}));
  std::mt19937 random(3);
  const int64_t start = map.revision;
  std::set<BlockIndex> changed;
  for (int round = 0; round < 20; ++round) {
    const std::vector<BlockIndex> touched = TouchSome(random, &map);
    const OccupancyDelta delta = watch.Update(map, touched);
    EXPECT_EQ(delta, copy.Update(map, touched, {}));
    EXPECT_LT(delta.blocks.size(), touched.size()) << "some were as before";
    for (const auto& block : delta.blocks) changed.insert(block.first);
    EXPECT_EQ(watch.Digest(0.02), copy.Digest());
    EXPECT_EQ(watch.size(), copy.size());
  }
  EXPECT_EQ(watch.ChangedAfter(start), std::vector<BlockIndex>(changed.begin(), changed.end()));
  EXPECT_TRUE(watch.ChangedAfter(map.revision).empty());
  watch.Clear();
  EXPECT_EQ(watch.Digest(0.02), OccupancyMap(0.02).Digest());
}

}  // namespace
}  // namespace vismap
