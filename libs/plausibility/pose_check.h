#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plausibility/frame_agreement.h"
#include "plausibility/pose_hypotheses.h"

namespace vismap {

/// Finds out whether the poses of a sequence can be right: surfaces that frames see must lie at the
/// same place in the world. It keeps coarse samples of a bounded number of frames, spread over the
/// sequence in couples of successive ones, and compares them with each other. It changes nothing of
/// the map.
class PoseCheck {
 public:
  /// `frames`: how many will be added; 0 = unknown. The samples are then chosen beforehand, so that
  /// few images are needed, and are the same in the end.
  explicit PoseCheck(int64_t frames = 0);

  /// Whether the depth of the next frame is needed.
  bool NeedsDepth() const;
  /// Frames of one camera in order of time. `depth` may be empty when it is not needed, or could
  /// not be read.
  void Add(const FrameHeader& header, const Image<float>& depth);

  /// How well the frames agree so far.
  AgreementSummary Compare() const;
  /// One sentence when most frames contradict each other, or when successive frames have no
  /// surface in common: what was found, and which likely mistakes would explain it; tried on these
  /// frames. Nothing when all is well or too few frames came. Costs some 200 ms when something is
  /// wrong.
  std::optional<std::string> Finding() const;

 private:
  void DropEverySecondCouple();
  void ForgetPosesFarFromSamples();
  bool IsNearASample(size_t index) const;
  std::vector<Pose> PosesOfSamples() const;
  std::string LikelyCauses(const AgreementSummary& found) const;

  size_t frames_ = 0;                 // that were added
  PosesByIndex T_W_C_;                // of the frames near the samples, and of the latest ones
  std::vector<FrameSample> samples_;  // couples of successive frames
  std::vector<size_t> indices_;       // of the samples among the frames
  size_t spacing_ = 2;                // a couple begins at every multiple of it
};

}  // namespace vismap
