#include "plausibility/pose_check.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace vismap {
namespace {

// Fewer frames may be far from each other for a good reason.
constexpr size_t kManyFrames = 6;
constexpr size_t kMaxSamples = 24;       // 276 pairs
constexpr size_t kMinFrames = 4;         // fewer are no sequence
constexpr double kMostFrames = 0.5;      // more contradicting frames than this are reported
constexpr double kLeastInCommon = 0.1;   // of the points of successive frames
constexpr int64_t kLeastInView = 2000;   // in view; fewer do not contradict by their closeness
constexpr double kGoodCloseness = 0.75;  // from here on no mistake is looked for
constexpr double kExplains = 0.55;       // closeness under a hypothesis that explains the data ...
constexpr double kMuchCloser = 0.25;     // ... and by how much it must be better
constexpr const char* kNoCause =
    "none of the usual mistakes explains it (world-to-camera poses, other camera axes, other "
    "units, "
    "order of the quaternion, times that are off)";

}  // namespace

PoseCheck::PoseCheck(int64_t frames) {
  const auto all = static_cast<size_t>(frames);
  while (2 * (all / spacing_) + std::min<size_t>(all % spacing_, 2) >= kMaxSamples) spacing_ *= 2;
}

bool PoseCheck::NeedsDepth() const {
  if (frames_ % spacing_ > 1) return false;  // between two couples
  return frames_ % spacing_ == 0 || (!indices_.empty() && indices_.back() + 1 == frames_);
}

void PoseCheck::Add(const FrameHeader& header, const Image<float>& depth) {
  const bool sample = NeedsDepth() && !depth.empty();
  const size_t index = frames_++;
  if (index % spacing_ == 0 && samples_.size() % 2 == 1) {  // the couple before is not complete
    samples_.pop_back();
    indices_.pop_back();
  }
  T_W_C_[index] = header.T_W_C;
  if (index > 2 * kPoseReach && !IsNearASample(index - 2 * kPoseReach - 1))
    T_W_C_.erase(index - 2 * kPoseReach - 1);
  if (!sample) return;
  samples_.push_back(MakeFrameSample(header, depth));
  indices_.push_back(index);
  if (samples_.size() == kMaxSamples) DropEverySecondCouple();
}

bool PoseCheck::IsNearASample(size_t index) const {
  const size_t first = index > kPoseReach ? index - kPoseReach : 0;
  const auto found = std::lower_bound(indices_.begin(), indices_.end(), first);
  return found != indices_.end() && *found <= index + kPoseReach;
}

// Only the latest poses may still become those of a neighbour of a sample.
void PoseCheck::ForgetPosesFarFromSamples() {
  std::erase_if(T_W_C_, [&](const auto& entry) {
    return entry.first + 2 * kPoseReach < frames_ && !IsNearASample(entry.first);
  });
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
  ForgetPosesFarFromSamples();
}

std::vector<Pose> PoseCheck::PosesOfSamples() const {
  std::vector<Pose> poses;
  for (const size_t i : indices_) poses.push_back(T_W_C_.at(i));
  return poses;
}

AgreementSummary PoseCheck::Compare() const { return CompareAllFrames(samples_, PosesOfSamples()); }

std::optional<std::string> PoseCheck::Finding() const {
  if (samples_.size() < kMinFrames) return std::nullopt;
  const AgreementSummary found = Compare();
  const double contradicting = found.ContradictingShare();
  const std::string causes =
      contradicting > kMostFrames || found.in_common < kLeastInCommon ||
              (found.all.in_view >= kLeastInView && found.all.Closeness() < kGoodCloseness)
          ? LikelyCauses(found)
          : "";
  const std::string explained = causes.empty() ? kNoCause : causes;
  if (contradicting > kMostFrames) {
    return "the frames contradict each other: in " + FormatPercent(contradicting) +
           " of the frames that were compared, most surface lies where other frames saw empty "
           "space; " +
           explained;
  }
  if (found.in_common < kLeastInCommon && (!causes.empty() || frames_ >= kManyFrames)) {
    return "successive frames have only " + FormatPercent(found.in_common) +
           " of their surface in common; " + explained;
  }
  if (causes.empty()) return std::nullopt;
  return "the frames contradict each other: only " + FormatPercent(found.all.Closeness()) +
         " of the surface points lie where other frames see surface; " + causes;
}

// The hypotheses under which frames agree much better, as a phrase; empty = there are none.
std::string PoseCheck::LikelyCauses(const AgreementSummary& found) const {
  struct Cause {
    double closeness = 0;
    double in_common = 0;
    std::string sentence;
    double total() const { return closeness + in_common; }
  };
  std::vector<Cause> causes;
  for (const PoseHypothesis& hypothesis : PoseHypotheses(T_W_C_, frames_, indices_)) {
    const AgreementSummary then = CompareAllFrames(samples_, hypothesis.T_W_C);
    const double closeness = then.all.Closeness();
    // Poses under which frames no longer move, or see nothing in common, agree without a reason.
    const bool judges = then.all.judged() >= found.all.judged() / 4;
    if (!judges || closeness < kExplains || closeness < found.all.Closeness() + kMuchCloser ||
        then.in_common < std::max(kLeastInCommon, found.in_common / 2) ||
        then.ContradictingShare() > 0.25)
      continue;
    causes.push_back({closeness, then.in_common, hypothesis.sentence});
  }
  if (causes.empty()) return "";
  std::stable_sort(causes.begin(), causes.end(),
                   [](const Cause& a, const Cause& b) { return a.total() > b.total(); });
  std::string text = "the likely cause: " + causes[0].sentence + " (then " +
                     FormatPercent(causes[0].closeness) +
                     " of the points lie on the surface of other frames, now " +
                     FormatPercent(found.all.Closeness()) + ")";
  for (size_t i = 1; i < causes.size() && i < 3; ++i) {
    if (causes[i].total() < causes[0].total() - 0.1) break;
    text += "; or " + causes[i].sentence + " (" + FormatPercent(causes[i].closeness) + ")";
  }
  return text;
}

}  // namespace vismap
