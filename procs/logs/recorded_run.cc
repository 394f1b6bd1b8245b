#include "logs/recorded_run.h"

#include <algorithm>

#include "wire/detections.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

// Whether a message has a frame that was sent before, and not another one with the same time.
bool LooksLikeACopy(const FrameHeader& header, const LogEvent& event, const RecordedFrame& frame) {
  return header.frame_number == frame.header.frame_number &&
         header.T_W_C.matrix() == frame.header.T_W_C.matrix() &&
         event.data_size == frame.copies.front().data_size;
}

bool IsDamaged(const LogReader& reader, const LogEvent& event) {
  return !ReadMessage<rgbd_frame_t>(reader, event, kRgbdFrameChannel);
}

// Adds a frame whose camera and utime another one has.
void AddAgain(const LogReader& reader, const LogEvent& event, const FrameHeader& header,
              RecordedRun* run, RecordedFrame* frame) {
  if (LooksLikeACopy(header, event, *frame) || IsDamaged(reader, event)) {
    frame->copies.push_back(event);
  } else if (std::all_of(frame->copies.begin(), frame->copies.end(),
                         [&](const LogEvent& copy) { return IsDamaged(reader, copy); })) {
    frame->header = header;
    frame->copies.push_back(event);
  } else {
    run->unusable_frames.push_back(
        {header.frame_number, "another frame of " +
                                  ToText(FrameKey{header.camera_id, header.utime}) +
                                  " is in the log before; every frame of a camera needs a utime "
                                  "of its own"});
  }
}

Result<void> AddFrame(const LogReader& reader, const LogEvent& event, RecordedRun* run) {
  const Result<std::vector<uint8_t>> bytes = reader.ReadData(event, kFramePeekBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  const Result<FrameHeader> header = PeekFrameHeader(*bytes, event.data_size);
  if (!header) {
    run->unusable_frames.push_back({-1, header.error().message});
    return {};
  }
  const auto [found, first] =
      run->index.try_emplace(FrameKey{header->camera_id, header->utime}, run->frames.size());
  if (first) {
    run->frames.push_back({*header, {event}});
  } else {
    AddAgain(reader, event, *header, run, &run->frames[found->second]);
  }
  return {};
}

void AddDetections(const LogReader& reader, const LogEvent& event, RecordedRun* run) {
  const auto message = ReadMessage<detections_t>(reader, event, kDetectionsChannel);
  if (message && DetectorRan(*message) && Decode(*message))
    run->detections.emplace(KeyOf(*message), event);
}

void AddCommit(const LogReader& reader, const LogEvent& event, RecordedRun* run) {
  auto message = ReadMessage<frame_commit_t>(reader, event, kMapCommitChannel);
  if (message) run->commits.push_back(std::move(*message));
}

}  // namespace

Result<RecordedRun> ReadRun(LogReader& reader) {
  RecordedRun run;
  int64_t events = 0;
  const auto on_event = [&](const LogEvent& event) -> Result<void> {
    ++events;
    const std::string channel = reader.OwnChannel(event);
    if (channel == kRgbdFrameChannel.name) return AddFrame(reader, event, &run);
    if (channel == kDetectionsChannel.name) AddDetections(reader, event, &run);
    if (channel == kMapCommitChannel.name) AddCommit(reader, event, &run);
    if (event.channel.ends_with(kRgbdFrameChannel.name)) run.other_frames = event.channel;
    return {};
  };
  const Result<void> read =
      ForEachEvent(reader, on_event, [&](const LogDamage&) { ++run.damaged; });
  if (!read) return tl::unexpected(read.error());
  if (events == 0) return Fail(reader.path() + ": the file has no LCM event");
  return run;
}

}  // namespace vismap
