#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace vismap {

/// Finds out whether the times of the frames of one camera can be right. It changes nothing.
class TimeCheck {
 public:
  /// The next frame of the camera, whose images were taken at `utime` [us].
  void Add(int64_t utime);

  /// One sentence when frames have the time of the frame before, when time runs backward in many of
  /// them, when the last time is after the year 2200, or when their distance is usual in another
  /// unit than microseconds.
  std::optional<std::string> Finding() const;

 private:
  static constexpr int kBins = 64;  // of the logarithm to base 2 of the distance [us]

  int64_t Median() const;

  int64_t frames_ = 0, repeated_ = 0, backward_ = 0;
  int64_t last_ = 0;                        // [us]
  std::array<int64_t, kBins> distances_{};  // how many are below 2^(i + 1)
};

}  // namespace vismap
