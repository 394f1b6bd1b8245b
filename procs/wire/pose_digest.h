#pragma once

#include <string>

#include "geometry/pose.h"

namespace vismap {

/// 16 hexadecimal digits that two poses share only if they are equal bit for bit.
std::string PoseDigest(const Pose& pose);

}  // namespace vismap
