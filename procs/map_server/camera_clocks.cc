#include "map_server/camera_clocks.h"

namespace vismap {

std::optional<std::string> CameraClocks::Check(const FrameKey& frame) {
  const auto [entry, first] = last_.try_emplace(frame.camera_id, frame.utime);
  const int64_t last = entry->second;
  entry->second = frame.utime;
  if (first) return std::nullopt;
  // Unsigned, since the difference of two times may not fit into int64_t.
  const bool backward = frame.utime < last;
  const uint64_t step = backward ? static_cast<uint64_t>(last) - static_cast<uint64_t>(frame.utime)
                                 : static_cast<uint64_t>(frame.utime) - static_cast<uint64_t>(last);
  if (backward) ++out_of_order_;
  if (step > static_cast<uint64_t>(kLargestStep)) {
    ++jumps_;
    return "the clock of camera " + std::to_string(Raw(frame.camera_id)) + " jumped " +
           (backward ? "back " : "ahead ") + std::to_string(step / 1'000'000) + " s at utime " +
           std::to_string(frame.utime) + "; the frame is integrated";
  }
  if (!backward) return std::nullopt;
  return ToText(frame) + " is older than the frame before; it is integrated";
}

}  // namespace vismap
