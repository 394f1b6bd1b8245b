#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "wire/frame_key.h"

namespace vismap {

/// Checks the times of the frames that are integrated. A map does not depend on them, so that every
/// frame is used; but frames out of order and jumps of a clock are counted and reported.
class CameraClocks {
 public:
  /// A step of a camera's clock beyond this is a jump [us].
  static constexpr int64_t kLargestStep = 60'000'000;

  /// Checks the next frame of a camera. Returns a sentence for the log when the frame is older than
  /// the one before, or its clock has jumped.
  std::optional<std::string> Check(const FrameKey& frame);

  int64_t out_of_order() const {
    return out_of_order_;
  }                                         ///< frames that were older than the one before
  int64_t jumps() const { return jumps_; }  ///< steps beyond kLargestStep

 private:
  std::map<CameraId, int64_t> last_;  // utime of the last frame [us]
  int64_t out_of_order_ = 0, jumps_ = 0;
};

}  // namespace vismap
