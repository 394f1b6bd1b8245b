#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "geometry/image.h"
#include "support/random_scenes.h"

namespace vismap::testing_support {

/// A regular or random pattern of holes.
struct HolePattern {
  std::string name;
  std::function<bool(int v, int u)> is_hole;  ///< called row by row, once for each pixel
};

/// Patterns that drivers and scaling make, and others of their kind. None has a hole that is wider
/// than 4 pixels along both its row and its column, but for few of the random ones.
inline std::vector<HolePattern> HolePatterns() {
  const auto random = std::make_shared<RandomNumbers>(7);
  return {
      {"every 4th row and column", [](int v, int u) { return v % 4 == 0 || u % 4 == 0; }},
      {"every 5th row and column", [](int v, int u) { return v % 5 == 2 || u % 5 == 0; }},
      {"every 3rd column", [](int, int u) { return u % 3 == 1; }},
      {"every 2nd row", [](int v, int) { return v % 2 == 0; }},
      {"two columns of three", [](int, int u) { return u % 3 != 0; }},
      {"two rows of four", [](int v, int) { return v % 4 < 2; }},
      {"checkerboard", [](int v, int u) { return (v + u) % 2 == 0; }},
      {"blocks of 2x2", [](int v, int u) { return v % 4 < 2 && u % 4 < 2; }},
      {"three pixels of four", [](int v, int u) { return v % 2 == 0 || u % 2 == 0; }},
      {"eight pixels of nine", [](int v, int u) { return v % 3 != 1 || u % 3 != 1; }},
      {"diagonals", [](int v, int u) { return (v + u) % 3 == 0; }},
      {"30 % at random", [random](int, int) { return random->Chance(0.3); }},
      {"half at random", [random](int, int) { return random->Chance(0.5); }},
  };
}

/// The depth image with holes (NaN) in a pattern.
inline Image<float> WithHoles(Image<float> depth, const HolePattern& pattern) {
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (pattern.is_hole(v, u)) depth(v, u) = std::numeric_limits<float>::quiet_NaN();
    }
  }
  return depth;
}

}  // namespace vismap::testing_support
