#pragma once

#include <string>
#include <vector>

#include "logs/log_reader.h"
#include "wire/frame_key.h"

namespace vismap {

/// The arrival of one RGBD_FRAME, DETECTIONS or SEGMENTED_FRAME message at the recorder.
struct Arrival {
  std::string channel;
  FrameKey frame;
  friend bool operator==(const Arrival&, const Arrival&) = default;
};

/// All arrivals in a log, in their order. Messages that cannot be decoded are left out.
Result<std::vector<Arrival>> ReadArrivals(LogReader& reader);

}  // namespace vismap
