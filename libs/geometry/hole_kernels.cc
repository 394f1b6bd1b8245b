#include "geometry/hole_kernels.h"

#include <cstring>
#include <limits>

#include "geometry/vector_clones.h"

// All kernels here are cloned: GCC 12 does not vectorise ordinary functions in the same file. The
// helpers are inlined into each clone, where their loops are vectorised.

#define VISMAP_INLINE inline __attribute__((always_inline))

namespace vismap {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();
constexpr float kNoFill = 1000;  // larger than the length of any fill

/// One number per pixel of a strip. Distances are floats, too, so that all lanes have one size.
struct alignas(64) Strip {
  float at[kHoleStrip];
};

/// The nearest pixels with depth on one side, and their distances; 0 = there is none near enough.
struct Side {
  Strip w, distance;
};

/// `step`: from each pixel to its next one on this side, in the image.
VISMAP_INLINE void FindSide(const float* w, ptrdiff_t step, Side* side) {
  static_assert(kMaxHolePx == 4);
  for (int u = 0; u < kHoleStrip; ++u) {
    const float w1 = w[u + step], w2 = w[u + 2 * step];
    const float w3 = w[u + 3 * step], w4 = w[u + 4 * step];
    const float near = w1 > 0 ? w1 : w2, far = w3 > 0 ? w3 : w4;
    const float near_distance = w1 > 0 ? 1.0F : 2.0F;
    const float far_distance = w3 > 0 ? 3.0F : (w4 > 0 ? 4.0F : 0.0F);
    side->w.at[u] = near > 0 ? near : far;
    side->distance.at[u] = near > 0 ? near_distance : far_distance;
  }
}

/// The slope of w beyond a side, away from the hole; 0 in `known` = unknown.
struct Slope {
  Strip slope, known;
};

/// Sets the slopes where `wanted` is not 0 and the side is `distance` pixels away.
VISMAP_INLINE void FindSlopeAt(const float* w, ptrdiff_t step, int distance, const Side& side,
                               const Strip& wanted, Slope* out) {
  static_assert(kMaxHolePx == 4);
  const auto wanted_distance = static_cast<float>(distance);
  int count = 0;
  for (int u = 0; u < kHoleStrip; ++u)
    count += wanted.at[u] > 0 && side.distance.at[u] == wanted_distance ? 1 : 0;
  if (count == 0) return;
  const float* from = w + distance * step;
  for (int u = 0; u < kHoleStrip; ++u) {
    const float w1 = from[u + step], w2 = from[u + 2 * step], w3 = from[u + 3 * step];
    const float w4 = from[u + 4 * step], w5 = from[u + 5 * step];
    const float near = w2 > 0 ? w2 : w1, near_distance = w2 > 0 ? 2.0F : 1.0F;
    const float middle = w3 > 0 ? w3 : near, middle_distance = w3 > 0 ? 3.0F : near_distance;
    const float far = w4 > 0 ? w4 : middle, far_distance = w4 > 0 ? 4.0F : middle_distance;
    const float behind = w5 > 0 ? w5 : far, behind_distance = w5 > 0 ? 5.0F : far_distance;
    const float slope = (behind - side.w.at[u]) / behind_distance;
    const float known = behind > 0 ? 1.0F : 0.0F, old_slope = out->slope.at[u];
    const float old_known = out->known.at[u];
    out->slope.at[u] = side.distance.at[u] == wanted_distance ? slope : old_slope;
    out->known.at[u] = side.distance.at[u] == wanted_distance ? known : old_known;
  }
}

VISMAP_INLINE void FindSlope(const float* w, ptrdiff_t step, const Side& side, const Strip& wanted,
                             Slope* out) {
  *out = {};
  for (int k = 1; k <= kMaxHolePx; ++k) FindSlopeAt(w, step, k, side, wanted, out);
}

/// What fills the pixels along one line: w, and the distance between the two sides of their hole,
/// kNoFill where nothing does.
struct Fill {
  Strip w, length;
};

/// A fill, and what decides whether it is good.
struct FillCandidate {
  Side before, after;
  Strip closed;       // 1: in a hole that is small enough
  Strip rise, limit;  // b - a, and the square of the largest difference that is noise
};

/// Finds the two sides of the holes along one line. Returns whether any is small enough.
VISMAP_INLINE bool FindSides(const float* w, ptrdiff_t step, const HoleConstants& k,
                             FillCandidate* candidate) {
  FindSide(w, -step, &candidate->before);
  FindSide(w, step, &candidate->after);
  int count = 0;
  for (int u = 0; u < kHoleStrip; ++u) {
    const float a = candidate->before.w.at[u], b = candidate->after.w.at[u];
    const float length = candidate->before.distance.at[u] + candidate->after.distance.at[u];
    const float closed = (w[u] > 0 ? 0.0F : 1.0F) * (a > 0 ? 1.0F : 0.0F) * (b > 0 ? 1.0F : 0.0F) *
                         (length <= k.max_length ? 1.0F : 0.0F);
    candidate->closed.at[u] = closed;
    count += closed > 0 ? 1 : 0;
  }
  return count > 0;
}

/// Sets `fill` where the two sides are equal within the noise.
VISMAP_INLINE void FindLevelFill(const HoleConstants& k, FillCandidate* candidate, Fill* fill) {
  for (int u = 0; u < kHoleStrip; ++u) {
    const float a = candidate->before.w.at[u], b = candidate->after.w.at[u];
    const float from_a = candidate->before.distance.at[u];
    const float length = from_a + candidate->after.distance.at[u];
    const float closed = candidate->closed.at[u];
    const float rise = b - a, middle = closed > 0 ? (a + b) * 0.5F : 1.0F;
    const float past = 1 / middle - k.axial_offset, beyond = past > 0 ? past : 0.0F;
    const float axial = (k.axial_base + k.axial_quadratic * beyond * beyond) * middle * middle;
    const float limit = k.sigmas_squared * (axial * axial + k.disparity_variance);
    const float level = rise * rise <= limit ? closed : 0.0F;
    candidate->rise.at[u] = rise;
    candidate->limit.at[u] = limit;
    fill->w.at[u] = a + rise * (from_a / (closed > 0 ? length : 1.0F));
    fill->length.at[u] = level > 0 ? length : kNoFill;
  }
}

/// Adds the fills on slopes where `unfilled` is not 0.
VISMAP_INLINE void AddSlopedFill(const float* w, ptrdiff_t step, const FillCandidate& candidate,
                                 const Strip& unfilled, Fill* fill) {
  Strip wanted;
  int count = 0;
  for (int u = 0; u < kHoleStrip; ++u) {
    wanted.at[u] = unfilled.at[u] * candidate.closed.at[u];
    count += wanted.at[u] > 0 ? 1 : 0;
  }
  if (count == 0) return;
  Slope before, after;
  FindSlope(w, -step, candidate.before, wanted, &before);
  FindSlope(w, step, candidate.after, wanted, &after);
  for (int u = 0; u < kHoleStrip; ++u) {
    const float length = candidate.before.distance.at[u] + candidate.after.distance.at[u];
    const float rise = candidate.rise.at[u], limit = candidate.limit.at[u];
    const float bend_before = rise + before.slope.at[u] * length;
    const float bend_after = rise - after.slope.at[u] * length;
    const float good = wanted.at[u] * before.known.at[u] * after.known.at[u] *
                       (bend_before * bend_before <= limit ? 1.0F : 0.0F) *
                       (bend_after * bend_after <= limit ? 1.0F : 0.0F);
    fill->length.at[u] = good > 0 ? length : fill->length.at[u];
  }
}

/// The fills along one line: along the row or down the column.
struct FillLine {
  ptrdiff_t step = 1;
  bool any = false;
  FillCandidate candidate;
  Fill fill;
};

VISMAP_INLINE void FindFills(const float* w, const HoleConstants& k, FillLine* line) {
  line->any = FindSides(w, line->step, k, &line->candidate);
  if (line->any) {
    FindLevelFill(k, &line->candidate, &line->fill);
  } else {
    for (int u = 0; u < kHoleStrip; ++u) line->fill.length.at[u] = kNoFill;
  }
}

/// Marks the pixels in small holes that have a fill along neither line yet. Returns whether there
/// are any.
VISMAP_INLINE bool FindUnfilled(const FillLine& along, const FillLine& down, Strip* unfilled) {
  int count = 0;
  for (int u = 0; u < kHoleStrip; ++u) {
    const float none = (along.fill.length.at[u] == kNoFill ? 1.0F : 0.0F) *
                       (down.fill.length.at[u] == kNoFill ? 1.0F : 0.0F);
    const float closed = along.candidate.closed.at[u] + down.candidate.closed.at[u];
    unfilled->at[u] = none * (closed > 0 ? 1.0F : 0.0F);
    count += none * closed > 0 ? 1 : 0;
  }
  return count > 0;
}

VISMAP_INLINE bool HasHole(const float* w) {
  int holes = 0;
  for (int u = 0; u < kHoleStrip; ++u) holes += w[u] == 0 ? 1 : 0;
  return holes > 0;
}

}  // namespace

VISMAP_VECTOR_CLONES void InvertDepth(const float* __restrict depth, int width,
                                      float* __restrict w) {
  for (int u = 0; u < width; ++u) {
    const float z = depth[u];
    const float in = (z > 0 ? 1.0F : 0.0F) * (z <= kLargest ? 1.0F : 0.0F);
    w[u] = in / (in > 0 ? z : 1.0F);
  }
}

VISMAP_VECTOR_CLONES void FillRow(const HoleRow& row, const HoleConstants& constants,
                                  float* __restrict out) {
  for (int first = 0; first < row.padded_width; first += kHoleStrip) {
    const float* w = row.w + first;
    if (!HasHole(w)) {
      std::memcpy(out + first, w, kHoleStrip * sizeof(float));
      continue;
    }
    FillLine lines[2];
    lines[1].step = row.stride;
    for (FillLine& line : lines) FindFills(w, constants, &line);
    if (Strip unfilled; FindUnfilled(lines[0], lines[1], &unfilled)) {
      for (FillLine& line : lines) {
        if (line.any) AddSlopedFill(w, line.step, line.candidate, unfilled, &line.fill);
      }
    }
    const Fill &along = lines[0].fill, &down = lines[1].fill;
    for (int u = 0; u < kHoleStrip; ++u) {
      const float length =
          along.length.at[u] <= down.length.at[u] ? along.length.at[u] : down.length.at[u];
      const float fill = along.length.at[u] <= down.length.at[u] ? along.w.at[u] : down.w.at[u];
      out[first + u] = length < kNoFill ? fill : w[u];
    }
  }
}

VISMAP_VECTOR_CLONES void AddFilledDepth(const float* __restrict w, int width,
                                         float* __restrict depth) {
  for (int u = 0; u < width; ++u) {
    const float z = depth[u], inverse = w[u];
    const float missing = (z > 0 ? 0.0F : 1.0F) + (z <= kLargest ? 0.0F : 1.0F);
    const float filled = 1 / (inverse > 0 ? inverse : 1.0F);
    const float other = inverse > 0 ? filled : z;
    depth[u] = missing > 0 ? other : z;
  }
}

}  // namespace vismap
