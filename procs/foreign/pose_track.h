#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>

#include "config/process_options.h"
#include "foreign/time_gate.h"
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
  /// replaces it. A sample whose time is more than ten seconds from where the others lead is held
  /// back until the next one: after a step back, as when a simulation begins again, the samples
  /// before it are forgotten. After a smaller step back, of more than one second, which two samples
  /// in a row have made, those that are not older than these two are forgotten: a simulation began
  /// again, or a SLAM sends its last seconds once more. Returns false when the sample before this
  /// one had a wrong time and is left out, see TimeGate.
  bool Add(int64_t utime, const Pose& pose, int64_t received);

  /// Forgets the oldest samples beyond this number, at least 2. Returns how many of them were less
  /// than two seconds older than the newest one, so that images may still wait for them.
  size_t KeepNewest(size_t samples);

  /// The receiver's clock was set back to `now` [us].
  void RestartWait(int64_t now) { first_received_ = std::min(first_received_, now); }

  /// The pose at a time. Unless the options say otherwise, an edge whose samples are all equal is a
  /// mount, which holds at any time, when it has two of them, or has had its only one for a second
  /// of the receiver's time `now`. When such an edge moves after all, its first pose still holds up
  /// to the last sample that had it; from there on, poses are found between two samples.
  Answer At(int64_t utime, int64_t now, const PoseLookupOptions& options) const;

  size_t size() const { return samples_.size(); }

 private:
  struct Sample {
    int64_t utime;
    Pose pose;
  };
  using SampleTimes = TimeGate<Pose>;
  void AddRight(const SampleTimes::Timed& sample);
  bool IsBack(const SampleTimes::Timed& sample) const;
  void Forget();
  void ForgetFrom(int64_t utime);
  void Insert(const SampleTimes::Timed& sample);
  void FollowRest(const SampleTimes::Timed& sample, std::deque<Sample>::const_iterator at);
  bool IsMount(int64_t now) const;
  Answer Between(int64_t utime, const PoseLookupOptions& options) const;

  static constexpr int64_t kKept = 10'000'000;  // [us]

  SampleTimes times_{kKept};
  std::deque<Sample> samples_;              // by time
  std::deque<int64_t> last_two_;            // times of the samples that came last, without back_
  std::optional<SampleTimes::Timed> back_;  // the last sample, if it is the first of a step back
  std::optional<int64_t> seam_;             // no pose is made of samples on both sides of it
  bool fixed_ = false;                      // a mount of the config
  bool unchanged_ = true;
  Pose rest_ = Pose::Identity();  // the first pose
  int64_t rest_until_ = -1;       // time of the last sample that had it
  int64_t count_ = 0;
  int64_t first_received_ = 0;
};

}  // namespace vismap
