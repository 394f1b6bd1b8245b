#pragma once

#include <map>
#include <string>
#include <vector>
#include <vismap/detections_t.hpp>
#include <vismap/frame_commit_t.hpp>
#include <vismap/rgbd_frame_t.hpp>

#include "geometry/frame.h"
#include "logs/log_reader.h"
#include "wire/channels.h"
#include "wire/envelope.h"
#include "wire/frame_key.h"

namespace vismap {

/// A frame in a log. Sent again, it is there several times; the copies may be damaged.
struct RecordedFrame {
  FrameHeader header;
  std::vector<LogEvent> copies;  ///< RGBD_FRAMEs with the key of this frame
};

/// What of a run a log holds that makes the map: where to find it, not the images themselves.
struct RecordedRun {
  std::vector<RecordedFrame> frames;         ///< in order of arrival, each camera and utime once
  std::map<FrameKey, size_t> index;          ///< into frames
  std::map<FrameKey, LogEvent> detections;   ///< DETECTIONS of frames that a detector looked at
  std::vector<frame_commit_t> commits;       ///< as recorded
  std::vector<std::string> unusable_frames;  ///< RGBD_FRAMEs whose header cannot be used, and why
  int64_t damaged = 0;                       ///< stretches of the file that are no events
};

/// Goes through the log once; images are not read. Fails when the file cannot be read, or has not
/// one event.
Result<RecordedRun> ReadRun(LogReader& reader);

/// The message of an event, checked as one that comes from the bus.
template <typename Message>
Result<Message> ReadMessage(const LogReader& reader, const LogEvent& event,
                            const Channel& channel) {
  const Result<std::vector<uint8_t>> bytes = reader.ReadData(event);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<Message> message = Unpack<Message>(*bytes, channel.max_bytes);
  if (!message) {
    return Fail(reader.path() + ", " + channel.name + " at byte " + std::to_string(event.offset) +
                ": " + message.error().message);
  }
  return message;
}

}  // namespace vismap
