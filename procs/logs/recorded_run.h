#pragma once

#include <map>
#include <string>
#include <vector>
#include <vismap/detections_t.hpp>
#include <vismap/frame_commit_t.hpp>
#include <vismap/rgbd_frame_t.hpp>

#include "datasets/dataset.h"
#include "geometry/frame.h"
#include "logs/log_reader.h"
#include "wire/channels.h"
#include "wire/envelope.h"
#include "wire/frame_key.h"

namespace vismap {

/// A frame in a log. A frame that was sent again has several copies, of which some may be damaged.
/// Copies have the same camera, utime, frame number and pose.
struct RecordedFrame {
  FrameHeader header;
  std::vector<LogEvent> copies;  ///< all RGBD_FRAME events of this frame
};

/// The parts of a log from which the map is built. Holds their positions in the log, not the
/// images.
struct RecordedRun {
  std::vector<RecordedFrame> frames;          ///< in order of arrival, each FrameKey once
  std::map<FrameKey, size_t> index;           ///< position in `frames`
  std::map<FrameKey, LogEvent> detections;    ///< DETECTIONS of frames on which a detector ran
  std::vector<frame_commit_t> commits;        ///< in recorded order
  std::vector<SkippedFrame> unusable_frames;  ///< RGBD_FRAMEs that cannot be used, and why
  int64_t damaged = 0;                        ///< number of damaged parts of the file
  std::string other_frames;  ///< a channel of RGBD_FRAMEs with another prefix; "" = there is none
};

/// Scans the whole log once, without reading the images. Fails when the file cannot be read or has
/// no event.
Result<RecordedRun> ReadRun(LogReader& reader);

/// Reads and decodes the message of an event, with the same checks as a message from the bus.
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
