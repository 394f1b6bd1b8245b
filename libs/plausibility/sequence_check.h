#pragma once

#include <map>
#include <string>
#include <vector>

#include "plausibility/depth_check.h"
#include "plausibility/pose_check.h"
#include "plausibility/time_check.h"

namespace vismap {

/// All checks of a sequence while it is mapped, for each of its cameras: UnusualCamera, TimeCheck,
/// PoseCheck and DepthCheck. It changes nothing.
class SequenceCheck {
 public:
  /// `frames`: how many frames each camera will have; 0 = unknown, see PoseCheck.
  explicit SequenceCheck(const DepthLimits& limits, int64_t frames = 0)
      : limits_(limits), expected_frames_(frames) {}

  /// The next frame as it goes into the map; `depth_unit_m` is that of its depth image, for
  /// messages.
  void Add(const SegmentedFrame& frame, double depth_unit_m);
  /// The same for a frame that was not segmented. `depth` may be empty when it could not be read or
  /// when it is not needed.
  void Add(const FrameHeader& header, const Image<float>& depth, double depth_unit_m);
  /// Whether the depth of the camera's next frame is needed.
  bool NeedsDepth(CameraId camera) const;

  /// Forgets the depth of the frames so far, but not their poses: for sequences without an end.
  void ForgetDepth();
  /// What is wrong, or suspect, with the likely cause, one sentence each; empty = all is well.
  std::vector<std::string> Findings() const;

 private:
  struct CameraChecks {
    PinholeCamera camera;
    PoseCheck poses;
    DepthCheck depth;
    TimeCheck times;
    double depth_unit_m = 0;
  };
  CameraChecks* ChecksOf(const FrameHeader& header);
  void Add(const FrameHeader& header, const Image<float>& depth, const SegmentImage* segments,
           double depth_unit_m);

  DepthLimits limits_;
  int64_t expected_frames_;
  std::map<CameraId, CameraChecks> cameras_;
};

}  // namespace vismap
