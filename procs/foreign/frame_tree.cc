#include "foreign/frame_tree.h"

#include <algorithm>
#include <numeric>

namespace vismap {
namespace {

constexpr size_t kMostFrames = 4096;
constexpr size_t kMostSamplesOfAll = 400'000;  // 64 MB
constexpr size_t kDeepest = 64;

std::string EdgeText(const std::string& parent, const std::string& child) {
  return "from '" + parent + "' to '" + child + "'";
}

}  // namespace

std::string FrameOfRobot(const std::string& frame, int robot) {
  return frame + "@" + std::to_string(robot);
}

void FrameTree::AddMount(const std::string& parent, const std::string& child,
                         const Pose& T_parent_child) {
  edges_[child] = {parent, PoseTrack::Fixed(T_parent_child), true};
}

size_t FrameTree::SamplesPerFrame() const {
  return kMostSamplesOfAll / std::max<size_t>(1, edges_.size());
}

size_t FrameTree::size() const {
  return std::accumulate(
      edges_.begin(), edges_.end(), size_t{0},
      [](size_t sum, const auto& entry) { return sum + entry.second.track.size(); });
}

// A new one takes its share of the samples from the others.
FrameTree::Edge& FrameTree::EdgeOf(const std::string& child) {
  const auto [at, is_new] = edges_.try_emplace(child);
  if (is_new) {
    for (auto& [name, edge] : edges_) edge.track.KeepNewest(SamplesPerFrame());
  }
  return at->second;
}

std::string FrameTree::Add(const EdgeSample& sample, int64_t received) {
  if (edges_.size() >= kMostFrames && !edges_.contains(sample.child))
    return "a pose of one more frame is left out, since " + std::to_string(kMostFrames) +
           " frames have poses already";
  Edge& edge = EdgeOf(sample.child);
  if (edge.mount) return "";
  if (edge.parent != sample.parent) edge = {sample.parent, {}, false};
  if (!edge.track.Add(sample.utime, sample.T_parent_child, received))
    return "a pose " + EdgeText(sample.parent, sample.child) +
           " has a time that is far from those of the poses around it";
  if (edge.track.KeepNewest(SamplesPerFrame()) > 0)
    return "poses " + EdgeText(sample.parent, sample.child) + " were forgotten early, since " +
           std::to_string(edges_.size()) + " frames share the room for " +
           std::to_string(kMostSamplesOfAll) + " poses";
  return "";
}

void FrameTree::RestartWaits(int64_t now) {
  for (auto& [name, edge] : edges_) edge.track.RestartWait(now);
}

std::vector<std::string> FrameTree::OfRobots(const std::string& frame) const {
  const std::string begin = frame + "@";
  std::vector<std::string> names;
  for (auto at = edges_.lower_bound(begin); at != edges_.end() && at->first.starts_with(begin);
       ++at)
    names.push_back(at->first);
  return names;
}

std::string FrameTree::Resolve(const std::string& frame) const {
  if (edges_.contains(frame)) return frame;
  const std::vector<std::string> names = OfRobots(frame);
  return names.size() == 1 ? names.front() : frame;
}

// The frame itself, its parent, and so on.
std::vector<std::string> FrameTree::PathToRoot(const std::string& frame) const {
  std::vector<std::string> path = {Resolve(frame)};
  while (path.size() < kDeepest) {
    const auto found = edges_.find(path.back());
    if (found == edges_.end()) break;
    path.push_back(Resolve(found->second.parent));
  }
  return path;
}

// T_path[end]_path[0].
FrameTree::Answer FrameTree::UpTo(const std::vector<std::string>& path, size_t end, int64_t utime,
                                  int64_t now) const {
  Answer answer{State::kFound};
  for (size_t i = 0; i < end; ++i) {
    const Edge& edge = edges_.at(path[i]);
    const PoseTrack::Answer at = edge.track.At(utime, now, options_);
    const std::string name = EdgeText(edge.parent, path[i]);
    switch (at.found) {
      case PoseTrack::Found::kPose:
        answer.pose = at.pose * answer.pose;
        break;
      case PoseTrack::Found::kLater:
        return {State::kWaiting, {}, "no pose " + name + " came that is later than the image"};
      case PoseTrack::Found::kTooOld:
        return {State::kNever, {}, "the image is older than all poses " + name};
      case PoseTrack::Found::kGap:
        // One between them may come late.
        return {State::kWaiting,
                {},
                "the poses " + name +
                    " around the image are too far apart in "
                    "time (adapter.max_gap_ms)"};
    }
  }
  return answer;
}

FrameTree::Answer FrameTree::Find(const std::string& target, const std::string& source,
                                  int64_t utime, int64_t now) const {
  const std::vector<std::string> up = PathToRoot(source), down = PathToRoot(target);
  for (size_t i = 0; i < up.size(); ++i) {
    const auto shared = std::find(down.begin(), down.end(), up[i]);
    if (shared == down.end()) continue;
    const Answer from_source = UpTo(up, i, utime, now);
    if (from_source.state != State::kFound) return from_source;
    const Answer from_target = UpTo(down, static_cast<size_t>(shared - down.begin()), utime, now);
    if (from_target.state != State::kFound) return from_target;
    return {State::kFound, from_target.pose.inverse() * from_source.pose};
  }
  if (const std::vector<std::string> names = OfRobots(up.back()); names.size() > 1) {
    return {State::kWaiting,
            {},
            "several robots have a frame '" + up.back() + "'; call it " + names[0] + " or " +
                names[1] + " (adapter.camera_frame, adapter.mounts)"};
  }
  return {State::kWaiting,
          {},
          "no poses connect the frame '" + source + "' with '" + target +
              "' (adapter.root, adapter.camera_frame, adapter.mounts); known "
              "frames: " +
              FramesText()};
}

std::string FrameTree::FramesText() const {
  constexpr size_t kShown = 20;
  std::string text;
  size_t shown = 0;
  for (const auto& [child, edge] : edges_) {
    if (shown++ == kShown) return text + ", ...";
    text += (text.empty() ? "" : ", ") + child;
  }
  return text.empty() ? "none" : text;
}

}  // namespace vismap
