#pragma once

#include <string>
#include <vector>

#include "plausibility/depth_check.h"
#include "plausibility/pose_check.h"

namespace vismap {

/// All checks of a sequence while it is mapped, see PoseCheck and DepthCheck. Frames of several
/// cameras may be mixed; poses are compared in the order of the frames.
class SequenceCheck {
 public:
  /// `depth_unit_m` is that of the sequence, for messages.
  SequenceCheck(const DepthLimits& limits, double depth_unit_m)
      : depth_(limits), depth_unit_m_(depth_unit_m) {}

  void Add(const SegmentedFrame& frame);
  /// What is wrong, or suspect, with the likely cause, one sentence each; empty = all is well.
  std::vector<std::string> Findings() const;

 private:
  PoseCheck poses_;
  DepthCheck depth_;
  double depth_unit_m_;
};

}  // namespace vismap
