#pragma once

#include <cstdint>

#include "geometry/surface.h"
#include "segmentation/runs.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// For every pixel, with which neighbours it lies on one surface: kLink bits. From the surface's
/// joined bits.
Image<uint8_t> LinkImage(const Image<uint8_t>& joined);

/// An image of regions that are numbered 1..count; 0 = none.
struct Regions {
  RegionImage image;
  int32_t count = 0;
};

/// 4-connected regions of at least `min_pixels` pixels with depth and strength 0 that are linked,
/// numbered 1, 2, ... by their first pixel in row order. `depth`: not 0 where there is some.
Regions ConnectedRegions(const Image<uint8_t>& depth, const Image<uint8_t>& links,
                         const Image<uint8_t>& strength, int min_pixels);

/// Lets regions grow along links into all that they can reach, over weak edges before strong ones
/// and near pixels before far ones, so that two regions meet on the ridge between them.
void FloodRegions(const Image<uint8_t>& depth, const Image<uint8_t>& links,
                  const Image<uint8_t>& strength, RegionImage* regions);

/// Turns what no region reached, where it hangs together over at least `min_pixels`, into regions
/// with the next numbers.
void AddMissedRegions(const Image<uint8_t>& depth, const Image<uint8_t>& links, int min_pixels,
                      Regions* regions);

/// Renumbers regions 0..n-1 by their first pixel in row order.
SegmentImage NumberRegions(const RegionImage& regions);

}  // namespace vismap
