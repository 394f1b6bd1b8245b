#include "plausibility/sequence_check.h"

#include <iterator>
#include <optional>

#include "plausibility/camera_check.h"

namespace vismap {

namespace {
constexpr size_t kMaxCameras = 16;  // others are not checked

// Also what is beyond the limits of depth, so that a wrong unit of the depth can be told.
const Image<float>& MeasuredDepth(const RgbdFrame& frame) {
  return frame.measured_depth.empty() ? frame.depth : frame.measured_depth;
}
}  // namespace

SequenceCheck::CameraChecks* SequenceCheck::ChecksOf(const FrameHeader& header) {
  auto found = cameras_.find(header.camera_id);
  if (found == cameras_.end()) {
    if (cameras_.size() == kMaxCameras) return nullptr;
    found = cameras_
                .emplace(header.camera_id,
                         CameraChecks{
                             header.camera, PoseCheck(expected_frames_), DepthCheck(limits_), {}})
                .first;
  }
  return &found->second;
}

void SequenceCheck::Add(const FrameHeader& header, const Image<float>& depth,
                        const SegmentImage* segments, double depth_unit_m) {
  CameraChecks* checks = ChecksOf(header);
  if (checks == nullptr) return;
  checks->camera = header.camera;
  checks->depth_unit_m = depth_unit_m;
  checks->times.Add(header.utime);
  checks->poses.Add(header, depth);
  if (!depth.empty()) checks->depth.Add(depth, segments);
}

void SequenceCheck::Add(const SegmentedFrame& frame, double depth_unit_m) {
  Add(frame.frame.header, MeasuredDepth(frame.frame), &frame.image, depth_unit_m);
}

void SequenceCheck::Add(const FrameHeader& header, const Image<float>& depth, double depth_unit_m) {
  Add(header, depth, nullptr, depth_unit_m);
}

bool SequenceCheck::NeedsDepth(CameraId camera) const {
  const auto found = cameras_.find(camera);
  return found != cameras_.end() ? found->second.poses.NeedsDepth() : cameras_.size() < kMaxCameras;
}

void SequenceCheck::ForgetDepth() {
  for (auto& [camera, checks] : cameras_) checks.depth = DepthCheck(limits_);
}

std::vector<std::string> SequenceCheck::Findings() const {
  std::vector<std::string> findings;
  for (const auto& [camera, checks] : cameras_) {
    std::vector<std::string> found = UnusualCamera(checks.camera);
    for (const std::optional<std::string>& finding :
         {checks.times.Finding(), checks.depth.RangeFinding(checks.depth_unit_m),
          checks.poses.Finding(), checks.depth.SegmentFinding()}) {
      if (finding) found.push_back(*finding);
    }
    for (std::string& finding : found) {
      if (cameras_.size() > 1) finding.insert(0, "camera " + std::to_string(Raw(camera)) + ": ");
      findings.push_back(std::move(finding));
    }
  }
  return findings;
}

}  // namespace vismap
