#pragma once

#include <cstddef>

namespace vismap {

// The loops of FillHoles over the pixels of a row. They have no branches for single pixels, so that
// they are vectorised, and are compiled once per SIMD level with equal results.
//
// w = inverse depth [1/m]; 0 = no depth. The method is explained in libs/METHOD.md, Holes.
//
// Every kernel names its twin: plain code for one pixel in tests/support/naive/fill_holes.cc. The
// tests FillHoles.EqualsTheNaiveOne* in tests/geometry/fill_holes_test.cc hold the two equal, bit
// for bit.

/// The widest hole that can be filled [px].
inline constexpr int kMaxHolePx = 4;
/// How far from a pixel FillRow reads in each direction [px]: the width of a hole, and as far again
/// to measure the slope beside it.
inline constexpr int kHoleReach = 2 * kMaxHolePx + 1;
/// Number of pixels that FillRow works on at a time.
inline constexpr int kHoleStrip = 32;

/// HoleOptions in the units of the kernels.
struct HoleConstants {
  float max_length = 0;  ///< from one side of a hole to the other: its width and 1 more [px]
  float sigmas_squared = 0;
  float axial_base = 0, axial_quadratic = 0, axial_offset = 0;  ///< see DepthNoiseModel
  float disparity_variance = 0;  ///< of w, by the steps of the disparity [1/m^2]
};

/// w = 1 / depth; 0 where the depth is not positive and finite. Twin: Inverse.
void InvertDepth(const float* depth, int width, float* w);

/// One row for FillRow.
struct HoleRow {
  const float* w;    ///< readable kHoleReach pixels beyond both ends, and as many rows away
  ptrdiff_t stride;  ///< pixels from row to row
  int padded_width;  ///< a multiple of kHoleStrip
};
/// Copies a row of w and fills its holes. For a hole between a, l pixels before it, and b, r pixels
/// after it in the same row or column, with l + r <= max_length, step = b - a and σ_w of the noise
/// model at (a + b) / 2:
///   |step| <= sigmas σ_w;  or, where that holds along neither line,
///   |step - (l + r) slope| <= sigmas σ_w  for both slopes beside it;
///   filled w = a + step l / (l + r).
/// The slope beside a is that to the farthest pixel with depth within kMaxHolePx + 1 pixels behind
/// it; without such a pixel the slopes do not count. The shorter line counts, the row when both are
/// equal.
/// Twin: FillPixel.
void FillRow(const HoleRow& row, const HoleConstants& constants, float* out);

/// Sets depth = 1 / w where it is not positive and finite but w is not 0. Twin: FillHoles.
void AddFilledDepth(const float* w, int width, float* depth);

}  // namespace vismap
