#include "foreign/pose_track.h"

#include <algorithm>
#include <cstdlib>

namespace vismap {
namespace {

constexpr int64_t kKept = 10'000'000;  // [us]
constexpr size_t kMostSamples = 20'000;
constexpr int64_t kOneSampleIsMount = 1'000'000;  // [us]
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

void PoseTrack::Add(int64_t utime, const Pose& pose, int64_t received) {
  if (fixed_) return;
  if (!samples_.empty() && utime < samples_.back().utime - kKept) {
    samples_.clear();
    count_ = 0;
    unchanged_ = true;
  }
  if (count_ == 0) first_received_ = received;
  ++count_;
  if (!samples_.empty() && !SamePose(samples_.back().pose, pose)) unchanged_ = false;
  const auto at = std::lower_bound(samples_.begin(), samples_.end(), utime,
                                   [](const Sample& s, int64_t time) { return s.utime < time; });
  if (at != samples_.end() && at->utime == utime) {
    at->pose = pose;
  } else {
    samples_.insert(at, {utime, pose});
  }
  while (samples_.size() > kMostSamples || samples_.front().utime < samples_.back().utime - kKept)
    samples_.pop_front();
}

bool PoseTrack::IsMount(int64_t now) const {
  if (fixed_) return true;
  return unchanged_ && (count_ >= 2 || now - first_received_ >= kOneSampleIsMount);
}

PoseTrack::Answer PoseTrack::At(int64_t utime, int64_t now,
                                const PoseLookupOptions& options) const {
  if (samples_.empty()) return {Found::kLater};
  const bool may_be_mount = fixed_ || options.constant_edges == ConstantEdges::kFixedWhenUnchanged;
  if (may_be_mount && IsMount(now)) return {Found::kPose, samples_.back().pose};
  if (may_be_mount && unchanged_) return {Found::kLater};  // whether it is a mount will show
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), utime,
                                      [](const Sample& s, int64_t time) { return s.utime < time; });
  if (after == samples_.end()) return {Found::kLater};
  if (after->utime == utime) return {Found::kPose, after->pose};
  if (after == samples_.begin()) return {Found::kTooOld};
  const auto before = std::prev(after);
  if (after->utime - before->utime > options.max_gap) return {Found::kGap};
  const double part = static_cast<double>(utime - before->utime) /
                      static_cast<double>(after->utime - before->utime);
  if (options.lookup == PoseLookup::kNearest)
    return {Found::kPose, part < 0.5 ? before->pose : after->pose};
  return {Found::kPose, InterpolatePose(before->pose, after->pose, part)};
}

}  // namespace vismap
