#pragma once

#include <cmath>

#include "base/random.h"
#include "geometry/image.h"

namespace vismap {

/// A smooth field of normal numbers with deviation 1 at every pixel: independent numbers on a grid
/// of `spacing` pixels, interpolated bilinearly and scaled back to deviation 1.
class NoiseField {
 public:
  NoiseField(int width, int height, int spacing, uint64_t key)
      : spacing_(spacing), nodes_(width / spacing + 2, height / spacing + 2) {
    for (size_t i = 0; i < nodes_.size(); ++i) nodes_.data()[i] = Normal(Mix(key, i));
  }

  double At(int v, int u) const {
    const int j = v / spacing_, i = u / spacing_;
    const double b = static_cast<double>(v % spacing_) / spacing_;
    const double a = static_cast<double>(u % spacing_) / spacing_;
    const double mean = (1 - b) * ((1 - a) * nodes_(j, i) + a * nodes_(j, i + 1)) +
                        b * ((1 - a) * nodes_(j + 1, i) + a * nodes_(j + 1, i + 1));
    const double variance = (a * a + (1 - a) * (1 - a)) * (b * b + (1 - b) * (1 - b));
    return mean / std::sqrt(variance);
  }

 private:
  int spacing_;
  Image<double> nodes_;
};

}  // namespace vismap
