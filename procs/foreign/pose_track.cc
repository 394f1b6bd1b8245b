#include "foreign/pose_track.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace vismap {
namespace {

constexpr size_t kMostSamples = 20'000;
constexpr int64_t kWaitedFor = 2'000'000;         // [us]
constexpr int64_t kOneSampleIsMount = 1'000'000;  // [us]
constexpr int64_t kStep = 1'000'000;              // a step back is larger [us]
constexpr double kEqual = 1e-9;

bool SamePose(const Pose& a, const Pose& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff() < kEqual;
}

}  // namespace

Pose InterpolatePose(const Pose& a, const Pose& b, double part) {
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(a.rotation()).slerp(part, Eigen::Quaterniond(b.rotation()));
  Pose pose = Pose::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() = (1 - part) * a.translation() + part * b.translation();
  return pose;
}

PoseTrack PoseTrack::Fixed(const Pose& pose) {
  PoseTrack track;
  track.fixed_ = true;
  track.samples_.push_back({0, pose});
  return track;
}

bool PoseTrack::Add(int64_t utime, const Pose& pose, int64_t received) {
  if (fixed_) return true;
  return !times_.Add(pose, utime, received,
                     [this](const SampleTimes::Timed& sample) { AddRight(sample); });
}

void PoseTrack::AddRight(const SampleTimes::Timed& sample) {
  if (sample.stepped_back) {
    Forget();
  } else if (!IsBack(sample)) {
    back_.reset();
  } else if (const auto first = std::exchange(back_, std::nullopt)) {
    ForgetFrom(std::min(first->utime, sample.utime));
    Insert(*first);
  } else {
    back_ = sample;
  }
  Insert(sample);
}

// Whether the sample is much older than both that came last, so that neither is a single wrong one.
bool PoseTrack::IsBack(const SampleTimes::Timed& sample) const {
  return last_two_.size() == 2 && sample.utime < std::min(last_two_[0], last_two_[1]) - kStep;
}

void PoseTrack::Forget() {
  samples_.clear();
  last_two_.clear();
  back_.reset();
  seam_.reset();
  count_ = 0;
  unchanged_ = true;
}

// A SLAM that sends its last seconds again, corrected, comes back to this time, and so does a
// simulation: what was before it stays, but no pose is made of both sides.
void PoseTrack::ForgetFrom(int64_t utime) {
  while (!samples_.empty() && samples_.back().utime >= utime) samples_.pop_back();
  if (samples_.empty()) return Forget();
  last_two_.clear();
  seam_ = utime;
  rest_until_ = std::min(rest_until_, samples_.back().utime);
}

void PoseTrack::Insert(const SampleTimes::Timed& sample) {
  if (!back_) last_two_.push_back(sample.utime);
  if (last_two_.size() > 2) last_two_.pop_front();
  if (count_ == 0) {
    first_received_ = sample.received;
    rest_ = sample.item;
    rest_until_ = sample.utime;
  }
  ++count_;
  auto at = std::lower_bound(samples_.begin(), samples_.end(), sample.utime,
                             [](const Sample& s, int64_t time) { return s.utime < time; });
  if (at != samples_.end() && at->utime == sample.utime) {
    at->pose = sample.item;
  } else {
    at = samples_.insert(at, {sample.utime, sample.item});
  }
  FollowRest(sample, at);
  KeepNewest(kMostSamples);
  while (samples_.front().utime < samples_.back().utime - kKept) samples_.pop_front();
}

// Notes how long the edge has rested in its first pose; `at` is the place of the new sample.
void PoseTrack::FollowRest(const SampleTimes::Timed& sample,
                           std::deque<Sample>::const_iterator at) {
  if (SamePose(rest_, sample.item)) {
    if (unchanged_) rest_until_ = std::max(rest_until_, at->utime);
    return;
  }
  const bool was_mount = count_ > 2 || sample.received - first_received_ >= kOneSampleIsMount;
  if (std::exchange(unchanged_, false) && !was_mount) rest_until_ = -1;
  if (at->utime <= rest_until_)
    rest_until_ = at == samples_.begin() ? int64_t{-1} : std::prev(at)->utime;
}

size_t PoseTrack::KeepNewest(size_t samples) {
  size_t waited_for = 0;
  while (samples_.size() > std::max<size_t>(2, samples)) {
    if (samples_.front().utime > samples_.back().utime - kWaitedFor) ++waited_for;
    samples_.pop_front();
  }
  return waited_for;
}

bool PoseTrack::IsMount(int64_t now) const {
  if (fixed_) return true;
  return unchanged_ && (count_ >= 2 || now - first_received_ >= kOneSampleIsMount);
}

PoseTrack::Answer PoseTrack::At(int64_t utime, int64_t now,
                                const PoseLookupOptions& options) const {
  if (samples_.empty()) return {Found::kLater};
  if (fixed_) return {Found::kPose, samples_.back().pose};
  if (options.constant_edges != ConstantEdges::kFixedWhenUnchanged) return Between(utime, options);
  if (IsMount(now)) return {Found::kPose, samples_.back().pose};
  if (unchanged_) return {Found::kLater};  // whether it is a mount will show
  if (utime <= rest_until_) return {Found::kPose, rest_};
  return Between(utime, options);
}

PoseTrack::Answer PoseTrack::Between(int64_t utime, const PoseLookupOptions& options) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), utime,
                                      [](const Sample& s, int64_t time) { return s.utime < time; });
  if (after == samples_.end()) return {Found::kLater};
  if (after->utime == utime) return {Found::kPose, after->pose};
  if (after == samples_.begin()) return {Found::kTooOld};
  const auto before = std::prev(after);
  if (seam_ && before->utime < *seam_ && *seam_ <= after->utime) return {Found::kGap};
  if (after->utime - before->utime > options.max_gap) return {Found::kGap};
  const double part = static_cast<double>(utime - before->utime) /
                      static_cast<double>(after->utime - before->utime);
  if (options.lookup == PoseLookup::kNearest)
    return {Found::kPose, part < 0.5 ? before->pose : after->pose};
  return {Found::kPose, InterpolatePose(before->pose, after->pose, part)};
}

}  // namespace vismap
