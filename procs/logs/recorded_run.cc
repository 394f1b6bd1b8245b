#include "logs/recorded_run.h"

#include "wire/detections.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

Result<void> AddFrame(const LogReader& reader, const LogEvent& event, RecordedRun* run) {
  const Result<std::vector<uint8_t>> bytes = reader.ReadData(event, kFramePeekBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  const Result<FrameHeader> header = PeekFrameHeader(*bytes);
  if (!header) {
    run->unusable_frames.push_back(header.error().message);
    return {};
  }
  const auto [found, first] =
      run->index.try_emplace(FrameKey{header->camera_id, header->utime}, run->frames.size());
  if (first) run->frames.push_back({*header, {}});
  run->frames[found->second].copies.push_back(event);
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
    if (event.channel == kRgbdFrameChannel.name) return AddFrame(reader, event, &run);
    if (event.channel == kDetectionsChannel.name) AddDetections(reader, event, &run);
    if (event.channel == kMapCommitChannel.name) AddCommit(reader, event, &run);
    return {};
  };
  const Result<void> read =
      ForEachEvent(reader, on_event, [&](const LogDamage&) { ++run.damaged; });
  if (!read) return tl::unexpected(read.error());
  if (events == 0) return Fail(reader.path() + ": the file has no LCM event");
  return run;
}

}  // namespace vismap
