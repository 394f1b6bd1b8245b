#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/pose.h"

namespace vismap {

/// The pose of a camera at a time.
struct PoseAtTime {
  int64_t utime = 0;  ///< [us]
  Pose T_W_C = Pose::Identity();
};

/// The part of a motion that a body has made when it moves along a screw, with constant linear and
/// angular velocity: exp(part * log(motion)) on SE(3). `part` in [0, 1].
Pose PartOfMotion(const Pose& motion, double part);

/// New poses for all frames of a camera when those of some are known, as a pose graph of key frames
/// gives them. Each known frame i has a correction D_i = T_new_i * T_old_i^-1. A frame at time t
/// between two known frames i and j gets D * T_old with D = D_i * PartOfMotion(D_i^-1 * D_j, (t -
/// t_i) / (t_j - t_i)). Before the first and after the last one, the correction of that one holds.
/// A known frame gets exactly its known pose. `corrected`: sorted by time, each of a time that
/// `frames` has; not empty. `frames`: in any order. Returns the poses in the order of `frames`.
std::vector<Pose> InterpolateCorrections(std::span<const PoseAtTime> frames,
                                         std::span<const PoseAtTime> corrected);

}  // namespace vismap
