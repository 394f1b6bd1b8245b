#include "detector/recorded_detector.h"

#include <vismap/rgbd_frame_t.hpp>

#include "base/format.h"
#include "wire/detections.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

Result<void> Answer(const rgbd_frame_t& message, const DetectionSource& source,
                    ProcessContext* context) {
  const StageTimer timer(context->status, "detection");
  const Result<FrameHeader> header = DecodeHeader(message);
  if (!header) return tl::unexpected(header.error());
  context->status->Set(ProcessState::kRunning);
  if (!source.DetectorRan(*header)) {
    context->bus->Publish(kDetectionsChannel, EncodeDetectorDidNotRun(*header));
    context->status->Count("frames_skipped");
    return {};
  }
  const Result<DetectionSet> set = source.ForFrame(*header);
  if (!set) return tl::unexpected(set.error());
  context->bus->Publish(kDetectionsChannel,
                        Encode(*set, header->camera.width, header->camera.height));
  context->status->Count("frames");
  context->status->Count("detections", static_cast<int64_t>(set->detections.size()));
  return {};
}

}  // namespace

Outcome RunRecordedDetector(const DetectionSource& source, int camera_id, ProcessContext& context) {
  context.bus->Subscribe<rgbd_frame_t>(kRgbdFrameChannel,
                                       [&](const rgbd_frame_t& message) -> Result<void> {
                                         if (camera_id >= 0 && message.camera_id != camera_id)
                                           return {};
                                         return Answer(message, source, &context);
                                       });
  context.status->Set(ProcessState::kReady);
  context.bus->Run();
  LogInfo("published " + FormatCount(context.status->counter("detections"), "detection") + " for " +
          FormatCount(context.status->counter("frames"), "frame"));
  return {};
}

}  // namespace vismap
