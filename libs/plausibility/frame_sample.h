#pragma once

#include "geometry/frame.h"

namespace vismap {

/// A coarse copy of a frame: every `step`-th pixel of its depth in both directions, with its camera
/// and pose. A few kilobytes, so that many frames can be compared with each other later.
struct FrameSample {
  FrameHeader header;
  int step = 1;        ///< pixels of the frame between two pixels of `depth`
  Image<float> depth;  ///< [m] along optical z; NaN = no return
  /// The nearest and the farthest depth in the 3x3 samples around each one; NaN = no return there.
  Image<float> nearest, farthest;
};

/// The sample of a frame whose larger side has at most `max_side` pixels.
FrameSample MakeFrameSample(const FrameHeader& header, const Image<float>& depth,
                            int max_side = 64);

}  // namespace vismap
