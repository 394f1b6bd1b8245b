#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "geometry/pose.h"

namespace vismap {

/// A mistake that people make with poses, and what the poses would be without it.
struct PoseHypothesis {
  std::string sentence;  ///< "the poses are world-to-camera"
  std::vector<Pose> T_W_C;
};

/// The largest number of frames by which the times of poses and images may be off.
inline constexpr size_t kPoseReach = 20;

/// Poses T_W_C of frames in order of time, by the index of the frame.
using PosesByIndex = std::map<size_t, Pose>;

/// The poses under every mistake that is known: world-to-camera, camera axes of OpenGL or of a
/// robot's body, translations in another unit than the depth, another order of the quaternion, and
/// times that are off by some frames. `known` has the poses of the last of `frames` frames and of
/// all those that are at most kPoseReach before or after one of the `chosen` ones, for which poses
/// are wanted.
std::vector<PoseHypothesis> PoseHypotheses(const PosesByIndex& known, size_t frames,
                                           const std::vector<size_t>& chosen);

}  // namespace vismap
