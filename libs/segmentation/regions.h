#pragma once

#include <cstdint>

#include "geometry/surface.h"
#include "segmentation/runs.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// The neighbours with which each pixel lies on one surface, as kLink bits; from
/// SurfaceMap::joined.
Image<uint8_t> LinkImage(const Image<uint8_t>& joined);

/// The images that regions are made of, all of one size. Name the members where you make one: the
/// images have the same type.
struct PixelGrid {
  const Image<uint8_t>& has_depth;      ///< not 0 where the pixel has depth
  const Image<uint8_t>& links;          ///< kLink bits
  const Image<uint8_t>& edge_strength;  ///< as SegmentImage::edge_strength
};

/// An image of regions that are numbered 1..count; 0 = none.
struct Regions {
  RegionImage image;
  int32_t count = 0;
};

/// The connected regions of linked pixels with depth and edge strength 0, numbered 1, 2, ... by
/// their first pixel in row order. Only regions of at least `min_pixels` count.
Regions ConnectedRegions(const PixelGrid& grid, int min_pixels);

/// Grows the regions along links to all pixels that they can reach (a watershed on the edge
/// strength): over weak edges before strong ones, and near pixels before far ones, so that two
/// regions meet where the edge between them is strongest.
void FloodRegions(const PixelGrid& grid, RegionImage* regions);

/// Adds the connected regions of linked pixels with depth that no region reached, with the next
/// numbers. Only regions of at least `min_pixels` count.
void AddMissedRegions(const PixelGrid& grid, int min_pixels, Regions* regions);

/// Renumbers regions 0..n-1 by their first pixel in row order.
SegmentImage NumberRegions(const RegionImage& regions);

}  // namespace vismap
