#pragma once

#include <cstddef>
#include <deque>
#include <optional>

namespace vismap {

/// The durations of a stage in the last minute, or the newest 4096 of them.
class RecentTimings {
 public:
  static constexpr double kWindow = 60;  ///< [s]
  static constexpr size_t kMost = 4096;
  /// Durations that half, and 95 of 100, do not exceed (nearest rank) [ms].
  struct Percentiles {
    double p50 = 0, p95 = 0;
  };

  /// A duration [ms] that ended at time `now` [s] of a clock that never goes back.
  void Add(double ms, double now);
  /// nullopt when there was none in the last minute.
  std::optional<Percentiles> At(double now);

 private:
  struct Entry {
    double at, ms;
  };
  std::deque<Entry> entries_;  // by time
};

}  // namespace vismap
