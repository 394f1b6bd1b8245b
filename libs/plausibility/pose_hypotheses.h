#pragma once

#include <string>
#include <vector>

#include "geometry/pose.h"

namespace vismap {

/// A mistake that people make with poses, and what the poses would be without it.
struct PoseHypothesis {
  std::string sentence;  ///< "the poses are world-to-camera"
  std::vector<Pose> T_W_C;
};

/// The poses under every mistake that is known: world-to-camera, camera axes of OpenGL or of a
/// robot's body, translations in another unit than the depth, another order of the quaternion, and
/// times that are off by some frames. `all` are the poses of all frames in order of time; `chosen`
/// are the indices of those for which poses are wanted.
std::vector<PoseHypothesis> PoseHypotheses(const std::vector<Pose>& all,
                                           const std::vector<size_t>& chosen);

}  // namespace vismap
