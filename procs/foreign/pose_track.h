#pragma once

#include <cstdint>
#include <deque>

#include "config/process_options.h"
#include "geometry/pose.h"

namespace vismap {

/// How poses between two samples are found.
struct PoseLookupOptions {
  PoseLookup lookup = PoseLookup::kInterpolate;
  int64_t max_gap = 100'000;  ///< longest time between two samples around an image [us]
  ConstantEdges constant_edges = ConstantEdges::kFixedWhenUnchanged;
};

/// Slerp of the rotation and linear interpolation of the translation; `part` in [0, 1].
Pose InterpolatePose(const Pose& a, const Pose& b, double part);

/// The poses of one edge of a tree of frames over time. It keeps ten seconds of them, at most
/// 20000.
class PoseTrack {
 public:
  enum class Found {
    kPose,    ///< `pose` is set
    kLater,   ///< the sample after this time has not come yet
    kTooOld,  ///< all samples are later
    kGap,     ///< the samples around this time are too far from each other
  };
  struct Answer {
    Found found = Found::kLater;
    Pose pose = Pose::Identity();
  };

  /// A mount: one pose for all times.
  static PoseTrack Fixed(const Pose& pose);

  /// Adds a sample of time `utime` that was received at `received` [us]. A sample of a known time
  /// replaces it. After a step back in time of more than ten seconds, as when a simulation begins
  /// again, the samples before are forgotten.
  void Add(int64_t utime, const Pose& pose, int64_t received);

  /// The pose at a time. Unless the options say otherwise, an edge whose samples are all equal is a
  /// mount, which holds at any time, when it has two of them, or has had its only one for a second
  /// of the receiver's time `now`.
  Answer At(int64_t utime, int64_t now, const PoseLookupOptions& options) const;

 private:
  struct Sample {
    int64_t utime;
    Pose pose;
  };
  bool IsMount(int64_t now) const;

  std::deque<Sample> samples_;  // by time
  bool fixed_ = false;          // a mount of the config
  bool unchanged_ = true;
  int64_t count_ = 0;
  int64_t first_received_ = 0;
};

}  // namespace vismap
