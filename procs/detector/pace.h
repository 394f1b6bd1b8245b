#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace vismap {

/// Counts the frames on which a detector runs and those that it skips, and how long it takes. It
/// has no clock of its own: callers pass the current time `now` [s].
class Pace {
 public:
  explicit Pace(double now) : since_(now) {}

  /// Adds a frame on which the detector ran for `ms`.
  void AddProcessed(double ms) { ms_.push_back(ms); }
  void AddSkipped() { ++skipped_; }

  /// A sentence on the frames since the last call, for example "runs on 4.8 of 30.0 frames per
  /// second, 147 ms per frame (median)"; nullopt when there were none.
  std::optional<std::string> Summarize(double now);

 private:
  double since_;
  std::vector<double> ms_;
  int64_t skipped_ = 0;
};

}  // namespace vismap
