#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plausibility/frame_agreement.h"

namespace vismap {

/// Finds out whether the poses of a sequence can be right: surfaces that frames see must lie at the
/// same place in the world. It keeps coarse samples of a bounded number of frames, spread over the
/// sequence in couples of successive ones, and compares them with each other. It changes nothing of
/// the map.
class PoseCheck {
 public:
  /// Frames of one camera in order of time.
  void Add(const FrameHeader& header, const Image<float>& depth);

  /// How well the frames agree so far.
  AgreementSummary Compare() const;
  /// One sentence when most frames contradict each other, or when successive frames have no
  /// surface in common: what was found, and which likely mistakes would explain it; tried on these
  /// frames. Nothing when all is well or too few frames came. Costs some 50 ms when something is
  /// wrong.
  std::optional<std::string> Finding() const;

 private:
  void DropEverySecondCouple();
  std::vector<Pose> PosesOfSamples() const;
  std::string LikelyCauses(const AgreementSummary& found) const;

  std::vector<Pose> T_W_C_;           // of all frames
  std::vector<FrameSample> samples_;  // couples of successive frames
  std::vector<size_t> indices_;       // of the samples in T_W_C_
  size_t spacing_ = 2;                // a couple begins at every multiple of it
};

}  // namespace vismap
