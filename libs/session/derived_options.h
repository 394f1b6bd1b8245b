#pragma once

#include "geometry/surface_options.h"
#include "session/map_session.h"

namespace vismap {

/// Sets the options that follow from others, so that the stages agree: association looks at the
/// depths that integration maps, and integration knows the noise of the sensor that `surface` is
/// set to, and depth has the same limits and holes are filled as for the segmentation.
void DeriveOptions(const SurfaceOptions& surface, MapSessionOptions* options);

}  // namespace vismap
