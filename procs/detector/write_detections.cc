#include "detector/write_detections.h"

#include <utility>
#include <vector>

#include "codecs/frame_codec.h"
#include "datasets/detections_file.h"
#include "runtime/progress.h"

namespace vismap {
namespace {

Result<DetectionSet> RunDetector(const Dataset& dataset, size_t i, DnnDetector* network) {
  const Result<SensorFrame> sensor = dataset.Read(i);
  if (!sensor) return tl::unexpected(sensor.error());
  const Result<RgbdFrame> frame = DecodeFrame(*sensor);
  if (!frame) return tl::unexpected(frame.error());
  if (frame->color.empty()) return DetectionSet{};
  return network->Detect(frame->color, frame->header);
}

}  // namespace

Outcome WriteDetections(const Dataset& dataset, DnnDetector* network, const std::string& out,
                        const StopSignal& stop) {
  Progress progress("detecting objects in " + dataset.name(), static_cast<int64_t>(dataset.size()));
  std::vector<DetectionSet> frames;
  for (size_t i = 0; i < dataset.size(); ++i) {
    progress.Show(static_cast<int64_t>(i));
    if (stop.requested())
      return ExitWith(ExitCode::kFailed, "stopped before the last frame; no file was written");
    Result<DetectionSet> detections = RunDetector(dataset, i, network);
    if (!detections) return ExitWith(ExitCode::kUnreadable, detections.error().message);
    frames.push_back(std::move(*detections));
  }
  const Result<void> written = WriteCocoResults(out, frames);
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  return {};
}

}  // namespace vismap
