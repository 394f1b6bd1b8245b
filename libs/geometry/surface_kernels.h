#pragma once

#include <cstdint>

namespace vismap {

// The loops of ComputeSurface over the pixels of a row. They have no branches, so that the compiler
// vectorises them, and are compiled once per SIMD level with equal results.
//
// Symbols of a pixel (u, v):
// - z: depth along the optical axis [m]
// - w = 1 / z: inverse depth, and σ_w = its standard deviation [1/m]; both 0 without depth
// - r = (r_x, r_y, 1) = ((u - cx) / fx, (v - cy) / fy, 1): the ray through the pixel
//
// The method is explained in libs/METHOD.md, Surface.
//
// Every kernel names its twin: plain code for one pixel in tests/support/naive/compute_surface.cc.
// The tests ComputeSurface.EqualsTheNaiveOne* in tests/geometry/naive_surface_test.cc (random
// scenes) and Pipeline.SurfacesAndSegmentsEqualTheNaiveOnes in tests/oracle/pipeline_oracle_test.cc
// (recordings) hold the two equal: bit for bit, normals within naive::kMaxNormalError.

/// Options, noise model and camera in the units of the kernels. Name the members where you set
/// them: most have the same type.
struct SurfaceConstants {
  float min_depth = 0, max_depth = 0;  ///< other depths count as none [m]
  float axial_base = 0;                ///< noise: see DepthNoiseModel [m]
  float axial_quadratic = 0;           ///< [1/m]
  float axial_offset = 0;              ///< [m]
  float disparity_sigma = 0;           ///< σ_w of the disparity steps [1/m]
  float radius_gain = 0;  ///< a window of radius sqrt(radius_gain σ_w z) is wide enough
  float min_radius = 0, max_radius = 0;  ///< of the window [px]
  float ray_x0 = 0;                      ///< r_x of the column u = 0
  float ray_step_x = 0;                  ///< 1 / fx: growth of r_x from column to column
  float jump_sigmas = 0;                 ///< see JumpSigmas
  /// The largest |w_q - w_p| / w_p of two neighbours in a row (in a column) on a visible surface:
  /// tan(largest angle between normal and ray) / fx (fy).
  float max_step_x = 0, max_step_y = 0;
};

/// One row for PreparePixels: `depth` is read, the others are written.
struct PixelRow {
  const float* depth;                  ///< [m]; NaN = none
  float *point_x, *point_y, *point_z;  ///< z r [m]; NaN without depth
  float *w, *sigma;                    ///< w and σ_w
  float* depth_sigma;                  ///< standard deviation of z [m]; 0 without depth
  uint8_t* radius;                     ///< of the window for the normal [px]; 0 without depth
};
/// Everything that depends on one pixel alone. With s(z) = axial_base + axial_quadratic
/// max(z - axial_offset, 0)^2:
///   point = z r,  w = 1 / z,  σ_w = sqrt((s(z) w^2)^2 + disparity_sigma^2),  σ_z = σ_w z^2,
///   radius = ceil(sqrt(radius_gain σ_w z)), within [min_radius, max_radius].
/// `ray_y` = r_y of the row. Twins: BackProject, InverseSigma, Radius.
void PreparePixels(const PixelRow& row, const SurfaceConstants& constants, float ray_y, int width);

/// Inverse depths of four pixels in line, of which the inner two, p and q, may lie on one surface,
/// and the deviations at those two.
struct PairRow {
  const float *before, *p, *q, *after, *sigma_p, *sigma_q;
};
/// Adds `bit` where p and q lie on one surface: both have depth, and their step is noise, or it is
/// the slope that the surface has before p or after q. With
///   limit = jump_sigmas max(σ_w(p), σ_w(q)),  step = w_q - w_p,
///   bend = min(|step - (w_p - w_before)|, |step - (w_after - w_q)|), slopes to missing pixels = 0:
///   |step| <= limit,  or  bend <= limit  and  |step| <= max_step w_p + limit.
/// Twin: Joined.
void JoinPairs(const PairRow& row, float jump_sigmas, float max_step, uint8_t bit, int count,
               uint8_t* out);

/// Upper limit of what ReachLeft and ReachRight count [px].
inline constexpr int kMaxReach = 32;
/// How many pixels each pixel of a row can go to the left (right) over pairs that are joined, at
/// most its radius, which is below kMaxReach. By doubling: what is known up to k pixels gives 2 k.
/// `scratch`: 2 * width bytes. Twin: Reach.
void ReachLeft(const uint8_t* joined, const uint8_t* radius, int width, uint8_t* scratch,
               uint8_t* out);
void ReachRight(const uint8_t* joined, const uint8_t* radius, int width, uint8_t* scratch,
                uint8_t* out);
/// The same down (up) the columns, from the reach of the next row below (above), `next`: one more
/// where the two pixels are joined. Twin: Reach.
void ReachFromNext(const uint8_t* next, const uint8_t* joined, const uint8_t* radius, int width,
                   uint8_t* out);

/// Sums over the stretch of one row that each pixel reaches, x counted from that pixel: of 1, x,
/// x^2, w and x w.
struct SumsRow {
  float *n, *x, *xx, *w, *xw;
};
/// One row for SumStretches: inverse depth, how far each pixel reaches, and the sums of w and of u
/// w over all pixels before the u-th (width + 1 numbers).
struct StretchRow {
  const float* w;
  const uint8_t *left, *right;
  const double *prefix_w, *prefix_uw;
};
/// Σ w = prefix_w(b) - prefix_w(a) and Σ x w = prefix_uw(b) - prefix_uw(a) - u Σ w, for the stretch
/// [a, b) = [u - left, u + right + 1); n, Σ x and Σ x^2 in closed form. All 0 where w is 0. Twin:
/// SumWindow.
void SumStretches(const StretchRow& row, int width, const SumsRow& out);

/// Number of pixels that FitPlanes works on at a time.
inline constexpr int kPlaneStrip = 16;

/// The input of FitPlanes for a strip of kPlaneStrip pixels of a row. All pointers are at the
/// strip's first pixel.
struct PlaneStrip {
  SumsRow sums;                    ///< of the rows, see SumStretches
  int stride = 0;                  ///< pixels from row to row of `sums`
  const uint8_t *up, *down;        ///< how far each pixel reaches [px]
  int rows_up = 0, rows_down = 0;  ///< the most that any of them reaches [px]
  const float* sigma;              ///< σ_w
  float fx = 0, fy = 0;            ///< [px]
  float ray_x = 0, ray_y = 0;      ///< r of the strip's first pixel
  float sigma_scale = 0;           ///< the noise's correlation length times max(fx, fy) [px^2]
};
/// Where FitPlanes writes: unit normals and their standard deviation [rad]; NaN = none.
struct NormalRow {
  float *x, *y, *z, *sigma;
};
/// The normal of the plane through each pixel's window. A plane is linear in inverse depth,
/// w = k . r with k = (a, b, c), so k follows by least squares from the moments of the window:
///   (a / fx, b / fy) = C^-1 (C_xw, C_yw),  c = mean w - a mean r_x - b mean r_y,
///   n = -k / |k|,  σ_n = σ_w sigma_scale sqrt(tr C / det C) / |k|,
/// with C = [C_xx C_xy; C_xy C_yy], C_xy = Σ x y - Σ x Σ y / n and so on. NaN where the window has
/// fewer than 5 pixels or is hardly more than a line (det C <= 0.2 n tr C), or where the plane lies
/// behind the camera (k . r <= 0 at the pixel). Twins: SumWindow, DefinesPlane, FitNormal.
void FitPlanes(const PlaneStrip& strip, const NormalRow& out);

}  // namespace vismap
