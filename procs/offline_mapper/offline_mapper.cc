#include "offline_mapper/offline_mapper.h"

#include <optional>
#include <utility>

#include "codecs/frame_codec.h"
#include "runtime/clock.h"

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
      !input.detections->LookedAt(sensor->header))
    return ready;
  Result<DetectionSet> detections = input.detections->ForFrame(sensor->header);
  if (!detections) return tl::unexpected(detections.error());
  ready.detections = std::move(*detections);
  return ready;
}

/// Lets the network look at a frame.
Result<void> LookAt(const OfflineInput& input, ReadyFrame* frame, StageTimes* times) {
  if (input.network == nullptr || frame->frame.color.empty()) return {};
  const double start = MonotonicSeconds();
  Result<DetectionSet> seen = input.network->Detect(frame->frame.color, frame->frame.header);
  if (!seen) return tl::unexpected(seen.error());
  times->Add("detection", (MonotonicSeconds() - start) * 1e3);
  frame->detections = std::move(*seen);
  return {};
}

void TakeFrame(ReadyFrame ready, const SegmentationStageOptions& options, MapSession& session,
               StageTimes& times) {
  const double start = MonotonicSeconds();
  const SegmentedFrame frame = SegmentFrame(
      std::move(ready.frame), ready.detections ? &*ready.detections : nullptr, options);
  const double segmented = MonotonicSeconds();
  const FrameAssociation association = session.Associate(frame);
  const double associated = MonotonicSeconds();
  session.Integrate(frame, association);
  const double integrated = MonotonicSeconds();
  times.Add("segmentation", (segmented - start) * 1e3);
  times.Add("association", (associated - segmented) * 1e3);
  times.Add("integration", (integrated - associated) * 1e3);
  times.Add("total", (integrated - start) * 1e3);
}

}  // namespace

Result<void> MapSequence(const OfflineInput& input, const SegmentationStageOptions& options,
                         const std::function<bool(size_t done)>& proceed, MapSession* session,
                         StageTimes* times) {
  const auto read = [&](size_t i) {
    const double start = MonotonicSeconds();
    Result<ReadyFrame> frame = ReadFrame(input, i);
    return std::make_pair(std::move(frame), (MonotonicSeconds() - start) * 1e3);
  };
  for (size_t i = 0; i < input.dataset.size() && proceed(i); ++i) {
    auto [frame, read_ms] = read(i);
    if (!frame) return tl::unexpected(frame.error());
    times->Add("reading", read_ms);
    const FrameHeader& header = frame->frame.header;
    if (session->Contains(header.camera_id, header.utime))
      continue;  // a continued map has it already
    if (const auto looked = LookAt(input, &*frame, times); !looked)
      return tl::unexpected(looked.error());
    TakeFrame(std::move(*frame), options, *session, *times);
  }
  return {};
}

}  // namespace vismap
