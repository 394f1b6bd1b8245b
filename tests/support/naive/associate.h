#pragma once

#include "association/associate.h"

namespace vismap::naive {

/// Associate with maps of counts: every overlap is counted anew after each label that is taken. The
/// same result as the fast one's, but for points within 1e-12 m of the border of two voxels.
FrameAssociation Associate(const SegmentedFrame& frame, const MapView& map,
                           const AssociationOptions& options);

}  // namespace vismap::naive
