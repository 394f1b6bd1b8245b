#pragma once

#include <compare>
#include <cstdint>
#include <string>

#include "base/ids.h"

namespace vismap {

/// Identifies one frame on the bus. Detections, commits and repeated frames are matched by it.
struct FrameKey {
  CameraId camera_id{0};
  int64_t utime = 0;  ///< [us]
  friend auto operator<=>(const FrameKey&, const FrameKey&) = default;
};

/// The key of a message that has the fields camera_id and utime.
template <typename Message>
FrameKey KeyOf(const Message& message) {
  return {CameraId{message.camera_id}, message.utime};
}

inline std::string ToText(const FrameKey& key) {
  return "camera " + std::to_string(Raw(key.camera_id)) + ", utime " + std::to_string(key.utime);
}

}  // namespace vismap
