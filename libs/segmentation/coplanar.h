#pragma once

#include "geometry/camera.h"
#include "segmentation/regions.h"

namespace vismap {

/// Joins neighbouring regions that lie on one plane within the noise, so that noise cannot shatter
/// walls and floors: from the largest region down, each takes in the joined neighbours whose mean
/// and spread about its plane are below `max_sigmas` standard deviations of inverse depth.
void JoinCoplanarRegions(const SurfaceMap& surface, const PinholeCamera& camera, double max_sigmas,
                         RegionImage* regions);

}  // namespace vismap
