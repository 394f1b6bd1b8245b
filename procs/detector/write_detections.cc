#include "detector/write_detections.h"

#include <utility>
#include <vector>

#include "base/reason_counts.h"
#include "datasets/detections_file.h"
#include "rectify/rectifier.h"
#include "runtime/progress.h"

namespace vismap {
namespace {

Result<RgbdFrame> ReadFrame(const Dataset& dataset, size_t i, Rectifier* rectifier) {
  const Result<SensorFrame> sensor = dataset.Read(i);
  if (!sensor) return tl::unexpected(sensor.error());
  Result<RgbdFrame> frame = rectifier->Decode(*sensor);
  if (frame && !frame->color_problem.empty()) return Fail(frame->color_problem);
  return frame;
}

}  // namespace

Outcome WriteDetections(const Dataset& dataset, DnnDetector* network, const std::string& out,
                        const StopSignal& stop) {
  Progress progress("detecting objects in " + dataset.name(), static_cast<int64_t>(dataset.size()));
  std::vector<DetectionSet> frames;
  ReasonCounts left_out;
  Rectifier rectifier;
  for (size_t i = 0; i < dataset.size(); ++i) {
    progress.Show(static_cast<int64_t>(i));
    if (stop.requested())
      return ExitWith(ExitCode::kFailed, "stopped before the last frame; no file was written");
    const Result<RgbdFrame> frame = ReadFrame(dataset, i, &rectifier);
    if (!frame) {
      left_out.Add(frame.error().message);
      continue;
    }
    if (frame->color.empty()) continue;
    Result<DetectionSet> detections = network->Detect(frame->color, frame->header);
    if (!detections) return ExitWith(ExitCode::kUnreadable, detections.error().message);
    frames.push_back(std::move(*detections));
  }
  const auto all = static_cast<int64_t>(dataset.size());
  if (left_out.total() == all)
    return ExitWith(ExitCode::kUnreadable,
                    dataset.name() + ": " + NoUsableFramesText(left_out, all));
  if (left_out.total() > 0) LogWarning(LeftOutText(left_out, all));
  const Result<void> written = WriteCocoResults(out, frames);
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  return {};
}

}  // namespace vismap
