#pragma once

#include <cstdint>

namespace vismap {

// The loops of ComputeSurface over the pixels of a row, free of branches so that the compiler
// vectorises them. Each is compiled once per SIMD level with equal results.

/// Depth range, noise model and camera, as the kernels want them; see MakeConstants.
struct SurfaceConstants {
  float low, high, base, quadratic, offset, step;
  float gain, min_radius, max_radius;
  float inv_fx, x0;
  float jump, cap_x, cap_y;
};

/// One row of everything that depends on a pixel alone.
struct PixelRow {
  const float* depth;
  float *x, *y, *z, *w, *sigma, *depth_sigma;
  uint8_t* radius;
};
void PreparePixels(const PixelRow& row, const SurfaceConstants& constants, float ray_y, int width);

/// Inverse depths of four pixels in line, of which the inner two, p and q, may be joined, and the
/// deviation at those two.
struct PairRow {
  const float *before, *p, *q, *after, *sigma_p, *sigma_q;
};
/// Adds `bit` where p[u] and q[u] lie on one surface. `cap` times p is the largest step that the
/// slope of a surface explains.
void JoinPairs(const PairRow& row, float jump, float cap, uint8_t bit, int count, uint8_t* out);

/// Longest stretch that ReachAlong counts [px].
inline constexpr int kMaxReach = 32;
/// How far each pixel of a row can go to the left (right) over pixels joined with the next, at most
/// its radius, which is below kMaxReach. `scratch`: 2 * width bytes.
void ReachLeft(const uint8_t* joined, const uint8_t* radius, int width, uint8_t* scratch,
               uint8_t* out);
void ReachRight(const uint8_t* joined, const uint8_t* radius, int width, uint8_t* scratch,
                uint8_t* out);
/// The reach of a row down (up) its columns from that of the row below (above) it.
void ReachFromNext(const uint8_t* next, const uint8_t* joined, const uint8_t* radius, int width,
                   uint8_t* out);

/// Sums over the stretch of one row around every pixel, x counted from that pixel: count, x, x^2,
/// inverse depth w, x w.
struct SumsRow {
  float *n, *x, *xx, *w, *xw;
};
/// What SumStretches reads: inverse depth, how far each pixel's stretch goes, and the sums of w and
/// u w over all pixels before the u-th (width + 1 numbers).
struct StretchRow {
  const float* w;
  const uint8_t *left, *right;
  const double *prefix_w, *prefix_uw;
};
void SumStretches(const StretchRow& row, int width, const SumsRow& out);

/// Pixels that FitPlanes works on at a time.
inline constexpr int kPlaneStrip = 16;

/// The images that FitPlanes reads around a strip of kPlaneStrip pixels; all pointers are at its
/// first pixel, `stride` = pixels from row to row.
struct PlaneStrip {
  SumsRow sums;
  int stride;
  const uint8_t *up, *down;
  int rows_up, rows_down;  ///< the farthest that any of them reaches
  const float* sigma;      ///< of inverse depth
  float fx, fy, ray_x, ray_y;
  float sigma_scale;
};
struct NormalRow {
  float *x, *y, *z, *sigma;
};
/// Least-squares plane w = a x + b y + c over the window of every pixel of the strip, turned into a
/// normal and its expected error; NaN where the window defines none.
void FitPlanes(const PlaneStrip& strip, const NormalRow& out);

}  // namespace vismap
