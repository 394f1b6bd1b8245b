#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace vismap {

/// How many of the frames a detector looks at, and how long that takes. Does not look at a clock.
class Pace {
 public:
  explicit Pace(double now) : since_(now) {}

  void AddProcessed(double ms) { ms_.push_back(ms); }
  void AddSkipped() { ++skipped_; }

  /// "looks at 4.8 of 30.0 frames per second, median 147 ms each": what came since the last call,
  /// `now` [s]; none when nothing did.
  std::optional<std::string> Summarize(double now);

 private:
  double since_;
  std::vector<double> ms_;
  int64_t skipped_ = 0;
};

}  // namespace vismap
