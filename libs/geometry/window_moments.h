#pragma once

#include <array>
#include <cstdint>

namespace vismap {

/// Columns worked on at a time, so that the sums stay in the L1 cache.
inline constexpr int kMomentStrip = 128;

/// Moments of the windows of a strip of pixels: x and y counted from each pixel, w = inverse depth.
struct Moments {
  std::array<float, kMomentStrip> n{}, x{}, y{}, xx{}, xy{}, yy{}, w{}, xw{}, yw{};
};

/// Sums over the stretch of one row around every pixel of a strip, x counted from that pixel.
struct SumsRow {
  const float *n, *x, *xx, *w, *xw;
};

/// Adds the row `dy` below the strip's own for the first `count` pixels, as far as they reach at
/// least |dy| that way.
void AddRow(const SumsRow& row, const uint8_t* reach, int dy, int count, Moments* moments);

}  // namespace vismap
