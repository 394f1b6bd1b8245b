#include "logs/check_recording.h"

#include <set>
#include <utility>

#include "plausibility/depth_losses.h"
#include "rectify/rectifier.h"

namespace vismap {
namespace {

int64_t CountCameras(const Dataset& dataset) {
  std::set<CameraId> cameras;
  for (size_t i = 0; i < dataset.size(); ++i) cameras.insert(dataset.Header(i).camera_id);
  return std::ssize(cameras);
}

}  // namespace

RecordingCheck CheckRecording(const Dataset& dataset, const DepthLimits& limits,
                              const SurfaceOptions& surface, CheckedFrames frames) {
  RecordingCheck result;
  for (const SkippedFrame& skipped : dataset.skipped()) result.left_out.Add(skipped.reason);
  if (dataset.size() == 0) return result;
  Rectifier rectifier;
  DepthLosses losses;
  SequenceCheck check(limits, static_cast<int64_t>(dataset.size()) / CountCameras(dataset));
  for (size_t i = 0; i < dataset.size(); ++i) {
    const FrameHeader header = dataset.Header(i);
    if (frames != CheckedFrames::kAll && !check.NeedsDepth(header.camera_id)) {
      check.Add(header, {}, dataset.depth_unit_m());
      continue;
    }
    Result<SensorFrame> sensor = dataset.Read(i);
    if (sensor) losses.Add(DropSaturatedDepth(surface, &*sensor));
    const Result<RgbdFrame> frame =
        sensor ? rectifier.Decode(*sensor) : Fail(sensor.error().message);
    if (!frame) {
      result.left_out.Add(frame.error().message);
      continue;
    }
    check.Add(frame->header, frame->depth, sensor->depth_unit_m);
    if (!frame->color_problem.empty()) result.without_color.Add(frame->color_problem);
  }
  result.findings = check.Findings();
  for (std::string& lost : FindingsOf(losses, surface)) result.findings.push_back(std::move(lost));
  return result;
}

}  // namespace vismap
