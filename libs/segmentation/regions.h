#pragma once

#include <vector>

#include "geometry/surface.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Working image of SegmentDepth: 0 = no region, otherwise an arbitrary positive number.
using RegionImage = Image<int32_t>;

/// 4-connected regions of pixels with depth and strength 0 that are joined in the surface.
RegionImage ConnectedRegions(const SurfaceMap& surface, const Image<uint8_t>& strength);

/// Lets regions grow along joined pixels into all that they can reach, over weak edges before
/// strong ones and near pixels before far ones, so that two regions meet on the ridge between them.
void FloodRegions(const SurfaceMap& surface, const Image<uint8_t>& strength, RegionImage* regions);

/// Turns what no region reached, where it hangs together over at least `min_pixels`, into regions.
void AddMissedRegions(const SurfaceMap& surface, int min_pixels, RegionImage* regions);

/// Gives regions below `min_pixels` to the region that most of their joined border touches, if that
/// is more than half of the border and the mean normals are within `max_angle` [rad].
void JoinSmallRegions(const SurfaceMap& surface, int min_pixels, double max_angle,
                      RegionImage* regions);

/// Clears regions below `min_pixels`.
void DropSmallRegions(int min_pixels, RegionImage* regions);

/// Renumbers regions 0..n-1 by their first pixel in row order.
SegmentImage NumberRegions(const RegionImage& regions);

}  // namespace vismap
