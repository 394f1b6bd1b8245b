#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "segmentation/segmented_frame.h"

namespace vismap {

/// Which depths [m] a map is made of.
struct DepthLimits {
  double nearest = 0.1;
  double farthest = 5.0;
};

/// Counts how much of the depth of a sequence is of use, so that an empty map can be explained. It
/// looks at every 4th pixel in both directions and changes nothing.
class DepthCheck {
 public:
  explicit DepthCheck(const DepthLimits& limits) : limits_(limits) {}

  /// A depth image as it goes into the map [m], and its segments; nullptr = it was not segmented.
  void Add(const Image<float>& depth, const SegmentImage* segments);
  void Add(const SegmentedFrame& frame) { Add(frame.frame.depth, &frame.image); }

  int64_t frames() const { return frames_; }
  double share_with_depth() const;   ///< of all pixels, [0, 1]
  double share_in_limits() const;    ///< of the pixels with depth, [0, 1]
  double share_in_segments() const;  ///< of the pixels with depth within the limits, [0, 1]
  double median() const;             ///< of the depths [m], to a few percent; 0 = there are none

  /// One sentence when there is hardly any depth, or hardly any within the limits, with the median
  /// depth and the unit that was taken [m].
  std::optional<std::string> RangeFinding(double depth_unit_m) const;
  /// One sentence when less than a third of the pixels with depth within the limits lie in
  /// segments, with the likely cause.
  std::optional<std::string> SegmentFinding() const;

 private:
  static constexpr int kBins = 768;  // of the depth, from 0.1 mm on, 32 to an octave

  DepthLimits limits_;
  int64_t frames_ = 0, pixels_ = 0, with_depth_ = 0, in_limits_ = 0;
  int64_t segmented_ = 0, in_segments_ = 0;  // pixels within the limits of segmented frames
  int64_t isolated_ = 0;  // pixels with depth that lack one of their four neighbours
  std::array<int64_t, kBins> histogram_{};
};

}  // namespace vismap
