#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/naive/compute_surface.h"

namespace vismap::naive {

/// Whether two images are equal; NaN equals NaN.
inline bool SameFloats(const Image<float>& a, const Image<float>& b) {
  return a.width() == b.width() && a.height() == b.height() &&
         std::equal(a.pixels().begin(), a.pixels().end(), b.pixels().begin(),
                    [](float x, float y) { return x == y || (x != x && y != y); });
}

/// Largest difference between two pixels; infinite when only one of the two is NaN.
inline float LargestDifference(const Image<float>& a, const Image<float>& b) {
  float largest = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const float x = a.data()[i], y = b.data()[i];
    if (x != x && y != y) continue;
    const float difference = std::abs(x - y);
    largest = difference >= 0 ? std::max(largest, difference) : INFINITY;
  }
  return largest;
}

/// Largest difference relative to `b`.
inline float LargestPart(Image<float> a, Image<float> b) {
  for (size_t i = 0; i < a.size(); ++i) {
    a.data()[i] /= b.data()[i];
    b.data()[i] /= b.data()[i];
  }
  return LargestDifference(a, b);
}

/// Checks what the comment of naive::ComputeSurface promises.
inline void ExpectEqualSurfaces(const SurfaceMap& fast, const SurfaceMap& slow) {
  EXPECT_TRUE(SameFloats(fast.points_C.x, slow.points_C.x));
  EXPECT_TRUE(SameFloats(fast.points_C.y, slow.points_C.y));
  EXPECT_TRUE(SameFloats(fast.points_C.z, slow.points_C.z));
  EXPECT_TRUE(SameFloats(fast.depth_sigma, slow.depth_sigma));
  EXPECT_EQ(fast.radius, slow.radius);
  EXPECT_EQ(fast.joined, slow.joined);
  EXPECT_EQ(fast.reach.left, slow.reach.left);
  EXPECT_EQ(fast.reach.right, slow.reach.right);
  EXPECT_EQ(fast.reach.up, slow.reach.up);
  EXPECT_EQ(fast.reach.down, slow.reach.down);
  EXPECT_LT(LargestDifference(fast.normals_C.x, slow.normals_C.x), kMaxNormalError);
  EXPECT_LT(LargestDifference(fast.normals_C.y, slow.normals_C.y), kMaxNormalError);
  EXPECT_LT(LargestDifference(fast.normals_C.z, slow.normals_C.z), kMaxNormalError);
  EXPECT_LT(LargestPart(fast.normal_sigma, slow.normal_sigma), kMaxNormalError);
}

}  // namespace vismap::naive
