#pragma once

#include <string>
#include <vector>

#include "geometry/camera.h"

namespace vismap {

/// What is unusual about a camera, one sentence each: a principal point more than a fifth of the
/// image off its middle, or an angle of view below 25 or above 130 degrees. Such cameras exist, but
/// most often the intrinsics are those of another image size. Empty = nothing is unusual.
std::vector<std::string> UnusualCamera(const PinholeCamera& camera);

}  // namespace vismap
