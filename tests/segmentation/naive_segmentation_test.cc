// The fast segmentation and the naive one give the same image.
#include <gtest/gtest.h>

#include "geometry/compute_surface.h"
#include "segmentation/segment_depth.h"
#include "support/naive/segment_depth.h"
#include "support/random_scenes.h"

namespace vismap {
namespace {

using testing_support::RandomNumbers;

int Compare(int width, int height, const SegmentationOptions& options, uint64_t seed) {
  SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height) + ", seed " +
               std::to_string(seed));
  RandomNumbers random(seed);
  const PinholeCamera camera = testing_support::RandomCamera(width, height, &random);
  const SurfaceMap surface =
      ComputeSurface(testing_support::RandomDepth(camera, &random), camera, {});
  const SegmentImage fast = SegmentDepth(surface, camera, options);
  const SegmentImage slow = naive::SegmentDepth(surface, camera, options);
  EXPECT_EQ(fast.segment_count, slow.segment_count);
  EXPECT_TRUE(fast.index == slow.index);
  EXPECT_TRUE(fast.edge_strength == slow.edge_strength);
  EXPECT_EQ(fast.loose.size(), slow.loose.size());
  EXPECT_TRUE(fast.loose == slow.loose);
  return fast.segment_count;
}

TEST(SegmentDepth, EqualsTheNaiveOneOnRandomScenesOfOddSizes) {
  int segments = 0;
  for (const auto& [width, height] : testing_support::kOddSizes) {
    for (uint64_t seed = 1; seed <= 20; ++seed) segments += Compare(width, height, {}, seed);
  }
  EXPECT_GT(segments, 500);  // the scenes are not empty
}

TEST(SegmentDepth, EqualsTheNaiveOneAroundTheUsualSize) {
  EXPECT_GT(Compare(641, 479, {}, 4), 1);
  EXPECT_GT(Compare(640, 480, {}, 5), 1);
}

TEST(SegmentDepth, EqualsTheNaiveOneWithOtherOptions) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    RandomNumbers random(seed + 100);
    SegmentationOptions options;
    options.min_segment_px = random.Whole(0, 3000);
    options.min_seed_px = random.Whole(0, 500);
    options.concave_angle_deg = random.Real(0, 60);
    options.concave_sigmas = random.Real(0, 5);
    options.sharp_angle_deg = random.Real(20, 90);
    options.coplanar_sigmas = random.Whole(0, 3);
    options.join_angle_deg = random.Real(0, 90);
    Compare(121, 93, options, seed);
  }
}

}  // namespace
}  // namespace vismap
