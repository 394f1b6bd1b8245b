#pragma once

#include <cstdint>

namespace vismap {

// The loops of rectifying depth over the pixels of a row of the depth image. They have no branches,
// so that the compiler vectorises them, and are compiled once per SIMD level with equal results.
// The formulas are in libs/METHOD.md, Rectification. Their twin is plain code for one pixel in
// tests/support/naive/rectify_depth.cc; Rectify.EqualsTheNaiveOne in tests/rectify/rectify_test.cc
// holds the two equal, bit for bit.

/// Neighbours whose inverse depths differ by more than this share of the smaller one do not lie on
/// one surface.
inline constexpr float kMaxJoinedStep = 0.04F;
/// The most pixels of the result along an axis that one pixel of depth covers.
inline constexpr int kMaxFootprint = 4;
/// By how much what a pixel covers is enlarged on each side, so that rounding leaves no gap [px].
inline constexpr float kFootprintMargin = 0.01F;
/// What is nearer to the colour camera than this is not used [m].
inline constexpr float kNearestDepth = 0.05F;
/// Depth of this and more is no depth: cameras that measure floats mark missing pixels by huge
/// values, whose products are infinite [m].
inline constexpr float kFarthestDepth = 1e6F;

/// Where the pixels of a row of depth appear in the rectified image.
struct ProjectedRow {
  float* x = nullptr;  ///< column [px]
  float* y = nullptr;  ///< row [px]
  float* w = nullptr;  ///< inverse depth [1/m]; 0 = no depth
};

/// Of a row of the depth image: with depth z [m], the point has depth Z = z rz + tz in the colour
/// camera and appears at ((z rx + tx) / Z, (z ry + ty) / Z). rx, ry, rz are NaN for a pixel without
/// a ray.
struct RayRow {
  const float* rx = nullptr;
  const float* ry = nullptr;
  const float* rz = nullptr;
  float tx = 0, ty = 0, tz = 0;
};

/// Projects the `count` depths `z` [m] (NaN = none) of a row.
void ProjectRow(const float* z, const RayRow& rays, int count, const ProjectedRow& out);

/// How far apart neighbours appear that have the same depth: one column and one row of depth on
/// [px].
struct PixelSteps {
  float column_x = 1, column_y = 0;
  float row_x = 0, row_y = 1;
};

/// What the pixels of a row cover: the columns x0..x1 and rows y0..y1 of the result (none if x0 >
/// x1), and the change of inverse depth from column to column and from row to row.
struct FootprintRow {
  int32_t* x0 = nullptr;
  int32_t* x1 = nullptr;
  int32_t* y0 = nullptr;
  int32_t* y1 = nullptr;
  float* gradient_x = nullptr;
  float* gradient_y = nullptr;
};

/// Measures what each of `count` pixels of the row `at` covers, from itself and its four
/// neighbours. `above` and `below` are the rows beside it. All three must be readable, with w = 0,
/// one pixel before and after the row. `width`, `height`: size of the result [px].
void MeasureRow(const ProjectedRow& above, const ProjectedRow& at, const ProjectedRow& below,
                const PixelSteps& steps, int width, int height, int count, const FootprintRow& out);

}  // namespace vismap
