#include "logs/arrivals.h"

#include <vismap/detections_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "logs/recorded_run.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

std::optional<FrameKey> KeyOfEvent(const LogReader& reader, const LogEvent& event) {
  const std::string channel = reader.OwnChannel(event);
  if (channel == kRgbdFrameChannel.name) {
    const Result<std::vector<uint8_t>> bytes = reader.ReadData(event, kFramePeekBytes);
    const Result<FrameHeader> header = bytes ? PeekFrameHeader(*bytes, event.data_size) : Fail("");
    if (header) return FrameKey{header->camera_id, header->utime};
  } else if (channel == kDetectionsChannel.name) {
    if (const auto message = ReadMessage<detections_t>(reader, event, kDetectionsChannel))
      return KeyOf(*message);
  } else if (channel == kSegmentedFrameChannel.name) {
    if (const auto message = ReadMessage<segmented_frame_t>(reader, event, kSegmentedFrameChannel))
      return KeyOf(message->frame);
  }
  return std::nullopt;
}

}  // namespace

Result<std::vector<Arrival>> ReadArrivals(LogReader& reader) {
  std::vector<Arrival> arrivals;
  const Result<void> read = ForEachEvent(
      reader,
      [&](const LogEvent& event) -> Result<void> {
        if (const std::optional<FrameKey> key = KeyOfEvent(reader, event))
          arrivals.push_back({reader.OwnChannel(event), *key});
        return {};
      },
      [](const LogDamage&) {});
  if (!read) return tl::unexpected(read.error());
  return arrivals;
}

}  // namespace vismap
