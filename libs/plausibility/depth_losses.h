#pragma once

#include <string>
#include <vector>

#include "geometry/saturated_depth.h"

namespace vismap {

/// One sentence for each kind of reading that is no measurement and makes up more than 5 % of the
/// pixels, with the likely cause and the key of the config that decides.
std::vector<std::string> FindingsOf(const DepthLosses& losses, const SurfaceOptions& options);

}  // namespace vismap
