#pragma once

#include <cstdint>
#include <vector>

#include "plausibility/frame_sample.h"

namespace vismap {

/// What the depth of one frame says about the surface points of another one.
struct PointCounts {
  int64_t points = 0;        ///< points of the first frame
  int64_t agree = 0;         ///< lie on the surface that the second frame sees
  int64_t seen_through = 0;  ///< lie clearly before it: the second frame saw empty space there
  int64_t in_view = 0;       ///< lie where the second frame has depth
  int64_t close = 0;         ///< of those, lie on its surface within the errors of good poses

  /// Of the points that the second frame can judge, the share that lies on its surface, [0, 1];
  /// 1 when it can judge none.
  double Agreement() const;
  /// Share of the points in view that are close, [0, 1]; 0 when there are none. Unlike Agreement it
  /// also counts points behind the surface, which may be hidden: about 0.9 with good poses.
  double Closeness() const;
  int64_t judged() const { return agree + seen_through; }
  PointCounts& operator+=(const PointCounts& other);
};

/// Transforms the points of `from` by the poses `T_W_C_from` and `T_W_C_to` into `to` and compares
/// them with its depth. A point counts as seen through when it is nearer than all depths in the 3x3
/// samples around its pixel by more than 2 cm and 6 % of its distance, so that depth edges and
/// slanted surfaces do not count. Points outside of the image count nothing, those behind its
/// surface only for Closeness, whose tolerance is 2 cm and 1.5 %.
PointCounts CompareFrames(const FrameSample& from, const Pose& T_W_C_from, const FrameSample& to,
                          const Pose& T_W_C_to);

/// How well frames agree with each other under some poses.
struct AgreementSummary {
  PointCounts all;                     ///< sums over all pairs that moved
  std::vector<PointCounts> per_frame;  ///< of each frame against all others
  /// Of the points of frames 2k, the share that lies on the surface of frames 2k + 1, [0, 1].
  double in_common = 0;

  /// Share of the frames that can be judged and of which less than 60 % of the points agree.
  double ContradictingShare() const;
};

/// Compares all pairs of `frames` whose poses differ by at least 5 degrees or 0.15 m, with
/// `T_W_C[i]` as the pose of frame i. `frames` are couples of successive frames (0 and 1, 2 and 3,
/// ...).
AgreementSummary CompareAllFrames(const std::vector<FrameSample>& frames,
                                  const std::vector<Pose>& T_W_C);

}  // namespace vismap
