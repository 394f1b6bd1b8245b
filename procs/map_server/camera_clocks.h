#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "wire/frame_key.h"

namespace vismap {

/// Watches the times of the frames that are integrated. A map does not depend on them, so nothing
/// is refused; but frames out of order and clocks that jump are told.
class CameraClocks {
 public:
  /// A step of a camera's clock beyond this is a jump [us].
  static constexpr int64_t kLargestStep = 60'000'000;

  /// Takes the next frame; a sentence when its time is remarkable.
  std::optional<std::string> Note(const FrameKey& frame);

  int64_t out_of_order() const { return out_of_order_; }  ///< older than one before
  int64_t jumps() const { return jumps_; }                ///< steps beyond kLargestStep

 private:
  std::map<CameraId, int64_t> last_;  // utime of the last frame
  int64_t out_of_order_ = 0, jumps_ = 0;
};

}  // namespace vismap
