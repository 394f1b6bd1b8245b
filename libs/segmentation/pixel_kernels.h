#pragma once

#include <cstdint>

#include "base/ids.h"

namespace vismap {

// The loops of SegmentDepth over the pixels of a row. They have no branches, so that the compiler
// vectorises them, and are compiled once per SIMD level with equal results.
//
// The method is explained in libs/METHOD.md, Segmentation.
//
// Rows of bytes are flags, 0 or 1, unless said otherwise. Rows `has_depth` are not 0 where the
// pixel has depth. Two neighbouring pixels are linked when there is no depth jump between them.
//
// Every kernel names its twin: plain code for one pixel in tests/support/naive/segment_depth.cc.
// The tests SegmentDepth.EqualsTheNaiveOne* in tests/segmentation/naive_segmentation_test.cc
// (random scenes) and Pipeline.SurfacesAndSegmentsEqualTheNaiveOnes in
// tests/oracle/pipeline_oracle_test.cc (recordings) hold the images that follow from them equal,
// bit for bit.

/// Packs a unit normal n in 32 bits: byte i = q_i = floor(127 n_i + 127.5) for i = x, y, z, and
/// byte 3 = 1; all bytes are 0 where n is NaN. With packed normals MarkFolds is fast; it decides
/// only which pixels need an exact test. Twin: none; FoldStrength tests every pixel exactly.
void PackNormals(const float* x, const float* y, const float* z, int width, uint32_t* out);

/// One row for MarkFolds. All pointers are at the row's first pixel.
struct FoldRow {
  const uint32_t* normals;  ///< packed; of the whole image, since `up` and `down` leave the row
  const uint8_t* has_depth;
  const uint8_t *left, *right, *up, *down;  ///< how far each pixel reaches, see PixelReach [px]
  int stride;                               ///< pixels from row to row
};
inline constexpr uint8_t kFoldAcross = 2, kFoldAlong = 4;  ///< bits that MarkFolds sets
/// kFoldAcross where |q(u + right) - q(u - left)|^2 >= min_square, kFoldAlong where the same holds
/// for up and down. Where a bit is not set, the normals are surely less than `chord` apart, for
/// min_square = PackedSquare(chord). Twin: FoldStrength.
void MarkFolds(const FoldRow& row, int min_square, int width, uint8_t* out);
/// For normals a and b with |a - b| >= chord: each q_i is off by at most half a step, so each
/// difference by at most one, and |q(a) - q(b)| >= 127 chord - sqrt(3). Returns the square of that,
/// which is rounded down first.
int PackedSquare(float chord);

inline constexpr uint8_t kLinkRight = 1, kLinkDown = 2, kLinkLeft = 4, kLinkUp = 8;
/// The kLink bits of the neighbours that each pixel is linked with, from SurfaceMap::joined, which
/// has only those to the right and down. `above` = `joined` of the row above, zeros for the first
/// row. Twin: ForNeighbors.
void LinkPixels(const uint8_t* joined, const uint8_t* above, int width, uint8_t* out);

/// One row for MarkRim; rows outside the image are zeros.
struct RimRow {
  const uint8_t* links;  ///< kLink bits
  const uint8_t *has_depth, *has_depth_above, *has_depth_below;
};
/// 1 where the pixel and one of its four neighbours have depth, but are not linked. Twin:
/// EdgeStrength.
void MarkRim(const RimRow& row, int width, uint8_t* out);

/// Marks the runs of a row.
struct RunFlags {
  uint8_t* in;  ///< the pixel belongs to a run
  uint8_t* on;  ///< it belongs to the same run as the pixel before it
};
/// One row for MarkFlat.
struct FlatRow {
  const uint8_t* has_depth;
  const uint8_t* edge_strength;  ///< 0..255
  const uint8_t* links;          ///< kLink bits
};
/// Runs of linked pixels with depth and edge strength 0. Twin: Connect.
void MarkFlat(const FlatRow& row, int width, RunFlags out);
/// One row for MarkMissed.
struct MissedRow {
  const uint8_t* has_depth;
  const int32_t* regions;  ///< 0 = none
  const uint8_t* links;    ///< kLink bits
};
/// Runs of linked pixels with depth and without region. Twin: AddMissedRegions.
void MarkMissed(const MissedRow& row, int width, RunFlags out);
/// Runs of pixels of one region; 0 = none. Twin: Measure.
void MarkRegions(const int32_t* regions, int width, RunFlags out);
/// Runs of pixels of one segment. Twin: NaiveRuns in tests/segmentation/segment_counts_test.cc,
/// held equal by SegmentRuns.EqualTheNaiveOnes.
void MarkSegments(const SegmentIndex* segments, int width, RunFlags out);

/// One row for MarkFront; rows outside the image may be any rows.
struct FrontRow {
  const uint8_t* links;  ///< kLink bits
  const uint8_t *has_depth, *has_depth_above, *has_depth_below;
  const int32_t *regions, *regions_above, *regions_below;  ///< 0 = none
};
/// 1 where a pixel with a region is linked with one that has depth and no region. Twin:
/// FloodRegions, which starts from all pixels with a region.
void MarkFront(const FrontRow& row, int width, uint8_t* out);

}  // namespace vismap
