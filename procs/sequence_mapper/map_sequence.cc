#include "sequence_mapper/map_sequence.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "rectify/rectifier.h"
#include "runtime/clock.h"
#include "session/map_frame.h"

namespace vismap {
namespace {

// Detections that cannot be read are an error at once when so many more frames have them than not.
constexpr int64_t kManyWithoutDetections = 5;

struct ReadyFrame {
  RgbdFrame frame;
  double depth_unit_m = 0;
  std::optional<DetectionSet> detections;
};

Result<ReadyFrame> ReadFrame(const Dataset& dataset, size_t i, const SurfaceOptions& options,
                             Rectifier* rectifier, DepthLosses* losses) {
  Result<SensorFrame> sensor = dataset.Read(i);
  if (!sensor) return tl::unexpected(sensor.error());
  losses->Add(DropSaturatedDepth(options, &*sensor));
  Result<RgbdFrame> frame = rectifier->Decode(*sensor);
  if (!frame) return tl::unexpected(frame.error());
  return ReadyFrame{std::move(*frame), sensor->depth_unit_m, std::nullopt};
}

Stopwatch WatchInto(StageTimes* times) {
  return {MonotonicSeconds, [times](const char* stage, double ms) { times->Add(stage, ms); }};
}

/// Maps the frames one after the other and counts what became of them.
class Mapper {
 public:
  Mapper(const OfflineInput& input, const SegmentationStageOptions& options, MapSession* session,
         StageTimes* times)
      : input_(input), options_(options), session_(*session), watch_(WatchInto(times)) {}

  Result<void> MapOne(size_t i) {
    const FrameHeader header = input_.dataset.Header(i);
    if (session_.Contains(header.camera_id, header.utime)) {
      mapped_.left_out.Add("the map has a frame of its camera and utime already");
      return {};
    }
    Result<ReadyFrame> frame = watch_.Measure("reading", [&] {
      return ReadFrame(input_.dataset, i, options_.surface, &rectifier_, &mapped_.depth_losses);
    });
    if (!frame) {
      mapped_.left_out.Add(frame.error().message);
      return {};
    }
    if (!frame->frame.color_problem.empty()) mapped_.without_color.Add(frame->frame.color_problem);
    if (const auto found = FindDetections(&*frame); !found) return found;
    const DetectionSet* detections = frame->detections ? &*frame->detections : nullptr;
    if (detections != nullptr) CountDetections(*detections);
    const auto check = [&](const SegmentedFrame& segmented) {
      if (input_.check != nullptr) input_.check->Add(segmented, frame->depth_unit_m);
      if (input_.on_segmented) input_.on_segmented(segmented);
    };
    const MappedFrame mapped = watch_.Measure("total", [&] {
      return MapFrame(std::move(frame->frame), detections, options_, &session_, watch_, check);
    });
    if (!mapped.delta.refused.empty()) {
      mapped_.left_out.Add(mapped.delta.refused);
      return {};
    }
    ++mapped_.frames;
    if (input_.on_mapped) input_.on_mapped(mapped.delta);
    mapped_.blocks_left_out += mapped.delta.blocks_left_out;
    return {};
  }

  Result<MappedSequence> Finish() && {
    if (const auto checked = CheckDetections(0); !checked) return tl::unexpected(checked.error());
    return std::move(mapped_);
  }

 private:
  /// Sets the recorded detections of the frame, or those that the network finds.
  Result<void> FindDetections(ReadyFrame* frame) {
    if (input_.network != nullptr) return RunNetwork(frame);
    if (input_.detections == nullptr || !input_.detections->DetectorRan(frame->frame.header))
      return {};
    Result<DetectionSet> detections = input_.detections->ForFrame(frame->frame.header);
    if (!detections) {
      mapped_.without_detections.Add(detections.error().message);
      return CheckDetections(kManyWithoutDetections);
    }
    frame->detections = std::move(*detections);
    ++with_detections_;
    return {};
  }

  Result<void> RunNetwork(ReadyFrame* frame) {
    if (frame->frame.color.empty()) return {};
    Result<DetectionSet> found = watch_.Measure("detection", [&] {
      return input_.network->Detect(frame->frame.color, frame->frame.header);
    });
    if (!found) return tl::unexpected(found.error());
    frame->detections = std::move(*found);
    return {};
  }

  void CountDetections(const DetectionSet& set) {
    mapped_.used_detections += static_cast<int64_t>(set.detections.size());
    mapped_.weak_detections +=
        std::count_if(set.detections.begin(), set.detections.end(), [](const Detection& detection) {
          return detection.score < kWeakScore || detection.mask.inside.empty();
        });
  }

  Result<void> CheckDetections(int64_t tolerance) const {
    const int64_t without = mapped_.without_detections.total();
    if (input_.is_part || without <= with_detections_ + tolerance) return {};
    return Fail("the detections of most frames cannot be used (" + std::to_string(without) +
                " of " + std::to_string(without + with_detections_) +
                " frames: " + mapped_.without_detections.Text() + ")");
  }

  const OfflineInput& input_;
  const SegmentationStageOptions& options_;
  MapSession& session_;
  Stopwatch watch_;
  MappedSequence mapped_;
  Rectifier rectifier_;
  int64_t with_detections_ = 0;  // frames whose recorded detections could be read
};

}  // namespace

Result<MappedSequence> MapSequence(const OfflineInput& input,
                                   const SegmentationStageOptions& options,
                                   const std::function<bool(size_t done)>& proceed,
                                   MapSession* session, StageTimes* times) {
  Mapper mapper(input, options, session, times);
  for (size_t i = input.first; i < input.dataset.size() && proceed(i); ++i) {
    if (const Result<void> mapped = mapper.MapOne(i); !mapped)
      return tl::unexpected(mapped.error());
  }
  return std::move(mapper).Finish();
}

}  // namespace vismap
