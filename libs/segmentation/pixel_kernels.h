#pragma once

#include <cstdint>

#include "base/ids.h"

namespace vismap {

// The loops of the segmentation over the pixels of a row, free of branches so that the compiler
// vectorises them. Each is compiled once per SIMD level with equal results. Rows of bytes are
// flags, 0 or 1, unless said otherwise.

/// A normal in 32 bits: components in steps of 1/127 from -1 in three bytes, 1 in the fourth; 0 =
/// none. Good for telling quickly that two are nearly parallel.
void PackNormals(const float* x, const float* y, const float* z, int width, uint32_t* out);

/// What MarkFolds reads of a row: the packed normals of the image from the row's first pixel on,
/// and how far each pixel looks.
struct FoldRow {
  const uint32_t* normals;
  const uint8_t *radius, *left, *right, *up, *down;
  int stride;
};
inline constexpr uint8_t kFoldAcross = 2, kFoldAlong = 4;  ///< bits that MarkFolds sets
/// Marks the pixels at which the normals left and right (up and down) may be `min_chord` or more
/// apart; those not marked are surely nearer.
void MarkFolds(const FoldRow& row, int min_square, int width, uint8_t* out);
/// The `min_square` for normals that are at least `chord` apart.
int PackedSquare(float chord);

inline constexpr uint8_t kLinkRight = 1, kLinkDown = 2, kLinkLeft = 4, kLinkUp = 8;
/// For each pixel, to which neighbours it is joined; `above` = the joined row above, zeros for the
/// first.
void LinkPixels(const uint8_t* joined, const uint8_t* above, int width, uint8_t* out);

/// Marks the pixels with depth that have a neighbour with depth which they are not joined with.
/// `above` and `below`: the radius rows, zeros outside the image.
void MarkRim(const uint8_t* links, const uint8_t* above, const uint8_t* radius,
             const uint8_t* below, int width, uint8_t* out);

/// What belongs to a run (`in`), and what goes on the run of the pixel before it (`on`).
struct RunFlags {
  uint8_t *in, *on;
};
/// Runs of pixels with depth and strength 0 that are joined.
void MarkFlat(const uint8_t* radius, const uint8_t* strength, const uint8_t* links, int width,
              RunFlags out);
/// Runs of pixels with depth and without region that are joined.
void MarkMissed(const uint8_t* radius, const int32_t* regions, const uint8_t* links, int width,
                RunFlags out);
/// Runs of pixels of one region.
void MarkRegions(const int32_t* regions, int width, RunFlags out);
/// Runs of pixels of one segment.
void MarkSegments(const SegmentIndex* segments, int width, RunFlags out);

/// Pixels with a region that are joined with one that has depth and none; region rows above and
/// below are any rows outside the image.
struct FrontRow {
  const uint8_t *links, *radius, *radius_above, *radius_below;
  const int32_t *regions, *above, *below;
};
void MarkFront(const FrontRow& row, int width, uint8_t* out);

}  // namespace vismap
