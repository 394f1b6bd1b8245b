#pragma once

#include <string>
#include <vector>

#include "logs/log_reader.h"
#include "wire/frame_key.h"

namespace vismap {

/// A message of one frame, as it came to the recorder: RGBD_FRAME, DETECTIONS or SEGMENTED_FRAME.
struct Arrival {
  std::string channel;
  FrameKey frame;
  friend bool operator==(const Arrival&, const Arrival&) = default;
};

/// Such messages of a log in the order of their arrival. What cannot be decoded is left out.
Result<std::vector<Arrival>> ReadArrivals(LogReader& reader);

}  // namespace vismap
