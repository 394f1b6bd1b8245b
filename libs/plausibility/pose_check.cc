#include "plausibility/pose_check.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "plausibility/pose_hypotheses.h"

namespace vismap {
namespace {

constexpr size_t kMaxSamples = 24;      // 276 pairs
constexpr size_t kMinFrames = 4;        // fewer are no sequence
constexpr double kMostFrames = 0.5;     // more contradicting frames than this are reported
constexpr double kLeastInCommon = 0.1;  // of the points of successive frames
constexpr double kExplains = 0.8;       // agreement under a hypothesis that explains the data

}  // namespace

void PoseCheck::Add(const FrameHeader& header, const Image<float>& depth) {
  const size_t index = T_W_C_.size();
  T_W_C_.push_back(header.T_W_C);
  if (index % spacing_ > 1) return;                               // between two couples
  if (index % spacing_ == 1 && indices_.size() % 2 == 0) return;  // its first one was not kept
  samples_.push_back(MakeFrameSample(header, depth));
  indices_.push_back(index);
  if (samples_.size() == kMaxSamples) DropEverySecondCouple();
}

void PoseCheck::DropEverySecondCouple() {
  size_t kept = 0;
  for (size_t i = 0; i < samples_.size(); ++i) {
    if (i / 2 % 2 == 1) continue;
    if (kept != i) samples_[kept] = std::move(samples_[i]);
    indices_[kept++] = indices_[i];
  }
  samples_.resize(kept);
  indices_.resize(kept);
  spacing_ *= 2;
}

std::vector<Pose> PoseCheck::PosesOfSamples() const {
  std::vector<Pose> poses;
  for (const size_t i : indices_) poses.push_back(T_W_C_[i]);
  return poses;
}

AgreementSummary PoseCheck::Compare() const { return CompareAllFrames(samples_, PosesOfSamples()); }

std::optional<std::string> PoseCheck::Finding() const {
  if (samples_.size() < kMinFrames) return std::nullopt;
  const AgreementSummary found = Compare();
  const double contradicting = found.ContradictingShare();
  if (contradicting > kMostFrames) {
    return "the frames contradict each other: in " + FormatPercent(contradicting) +
           " of the frames that were compared, most surface lies where other frames saw empty "
           "space; " +
           LikelyCauses(found);
  }
  if (found.in_common < kLeastInCommon) {
    return "successive frames have only " + FormatPercent(found.in_common) +
           " of their surface in common; " + LikelyCauses(found);
  }
  return std::nullopt;
}

std::string PoseCheck::LikelyCauses(const AgreementSummary& found) const {
  struct Cause {
    double agreement = 0;
    double in_common = 0;
    std::string sentence;
  };
  std::vector<Cause> causes;
  for (const PoseHypothesis& hypothesis : PoseHypotheses(T_W_C_, indices_)) {
    const AgreementSummary then = CompareAllFrames(samples_, hypothesis.T_W_C);
    const double agreement = then.all.Agreement();
    // Poses under which frames no longer move, or see nothing in common, agree without a reason.
    const bool judges = then.all.judged() >= found.all.judged() / 4;
    if (!judges || agreement < kExplains ||
        then.in_common < std::max(kLeastInCommon, found.in_common / 2) ||
        then.ContradictingShare() > 0.25)
      continue;
    causes.push_back({agreement, then.in_common, hypothesis.sentence});
  }
  if (causes.empty()) {
    return "none of the usual mistakes explains it (world-to-camera poses, other camera axes, "
           "other units, order of the quaternion, times that are off)";
  }
  std::stable_sort(causes.begin(), causes.end(), [](const Cause& a, const Cause& b) {
    return a.agreement + a.in_common > b.agreement + b.in_common;
  });
  std::string text = "the likely cause: " + causes[0].sentence + " (then " +
                     FormatPercent(causes[0].agreement) + " of the points agree, now " +
                     FormatPercent(found.all.Agreement()) + ")";
  for (size_t i = 1; i < causes.size() && i < 3; ++i) {
    if (causes[i].agreement + causes[i].in_common < causes[0].agreement + causes[0].in_common - 0.1)
      break;
    text += "; or " + causes[i].sentence + " (" + FormatPercent(causes[i].agreement) + ")";
  }
  return text;
}

}  // namespace vismap
