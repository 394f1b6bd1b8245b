// The fast surface and the naive one are equal.
#include <gtest/gtest.h>

#include "geometry/compute_surface.h"
#include "support/naive/surface_checks.h"
#include "support/random_scenes.h"

namespace vismap {
namespace {

using testing_support::RandomNumbers;

void Compare(int width, int height, const SurfaceOptions& options, uint64_t seed) {
  SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height) + ", seed " +
               std::to_string(seed));
  RandomNumbers random(seed);
  const PinholeCamera camera = testing_support::RandomCamera(width, height, &random);
  const Image<float> depth = testing_support::RandomDepth(camera, &random);
  naive::ExpectEqualSurfaces(ComputeSurface(depth, camera, options),
                             naive::ComputeSurface(depth, camera, options));
}

TEST(ComputeSurface, EqualsTheNaiveOneOnRandomScenesOfOddSizes) {
  for (const auto& [width, height] : testing_support::kOddSizes) {
    for (uint64_t seed = 1; seed <= 12; ++seed) Compare(width, height, {}, seed);
  }
}

TEST(ComputeSurface, EqualsTheNaiveOneAroundTheUsualSize) {
  Compare(641, 479, {}, 1);
  Compare(640, 480, {}, 2);
}

TEST(ComputeSurface, EqualsTheNaiveOneWithTheLargestWindows) {
  SurfaceOptions options;
  options.min_radius_px = 31;
  options.max_radius_px = 31;
  options.jump_sigmas = 20;
  for (uint64_t seed = 1; seed <= 5; ++seed) Compare(90, 70, options, seed);
}

}  // namespace
}  // namespace vismap
