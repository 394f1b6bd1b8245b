#include "offline_mapper/offline_mapper.h"

#include <optional>
#include <utility>

#include "codecs/frame_codec.h"
#include "runtime/clock.h"
#include "session/map_frame.h"

namespace vismap {
namespace {

struct ReadyFrame {
  RgbdFrame frame;
  std::optional<DetectionSet> detections;
};

Result<ReadyFrame> ReadFrame(const OfflineInput& input, size_t i) {
  const Result<SensorFrame> sensor = input.dataset.Read(i);
  if (!sensor) return tl::unexpected(sensor.error());
  Result<RgbdFrame> frame = DecodeFrame(*sensor);
  if (!frame) {
    return Fail(input.dataset.name() + ", frame " + std::to_string(sensor->header.frame_number) +
                ": " + frame.error().message);
  }
  ReadyFrame ready{std::move(*frame), std::nullopt};
  if (input.network != nullptr || input.detections == nullptr ||
      !input.detections->DetectorRan(sensor->header))
    return ready;
  Result<DetectionSet> detections = input.detections->ForFrame(sensor->header);
  if (!detections) return tl::unexpected(detections.error());
  ready.detections = std::move(*detections);
  return ready;
}

Stopwatch WatchInto(StageTimes* times) {
  return {MonotonicSeconds, [times](const char* stage, double ms) { times->Add(stage, ms); }};
}

/// Runs the network, if there is one, on the frame's colour image.
Result<void> DetectObjects(const OfflineInput& input, const Stopwatch& watch, ReadyFrame* frame) {
  if (input.network == nullptr || frame->frame.color.empty()) return {};
  Result<DetectionSet> found = watch.Measure(
      "detection", [&] { return input.network->Detect(frame->frame.color, frame->frame.header); });
  if (!found) return tl::unexpected(found.error());
  frame->detections = std::move(*found);
  return {};
}

}  // namespace

Result<int64_t> MapSequence(const OfflineInput& input, const SegmentationStageOptions& options,
                            const std::function<bool(size_t done)>& proceed, MapSession* session,
                            StageTimes* times) {
  const Stopwatch watch = WatchInto(times);
  const auto check = [&](const SegmentedFrame& segmented) {
    if (input.check != nullptr) input.check->Add(segmented);
  };
  int64_t used_detections = 0;
  for (size_t i = 0; i < input.dataset.size() && proceed(i); ++i) {
    Result<ReadyFrame> frame = watch.Measure("reading", [&] { return ReadFrame(input, i); });
    if (!frame) return tl::unexpected(frame.error());
    const FrameHeader& header = frame->frame.header;
    if (session->Contains(header.camera_id, header.utime)) continue;  // of a map that is continued
    if (const auto detected = DetectObjects(input, watch, &*frame); !detected)
      return tl::unexpected(detected.error());
    const DetectionSet* detections = frame->detections ? &*frame->detections : nullptr;
    if (detections != nullptr)
      used_detections += static_cast<int64_t>(detections->detections.size());
    watch.Measure("total", [&] {
      MapFrame(std::move(frame->frame), detections, options, session, watch, check);
    });
  }
  return used_detections;
}

}  // namespace vismap
