#pragma once

#include <string>

#include "base/result.h"
#include "geometry/pose.h"

namespace vismap {

/// A pose that never changes, from the config.
struct Mount {
  std::string parent, child;
  Pose T_parent_child = Pose::Identity();
};

/// Parses "parent child x y z qw qx qy qz" (metres, unit quaternion). Fails on anything else.
Result<Mount> ParseMount(const std::string& text);

}  // namespace vismap
