#pragma once

#include <functional>

namespace vismap {

/// Measures how long stages of work take. The libraries read no clock themselves: the caller passes
/// one in, together with the place where the durations go. Without a clock nothing is measured.
struct Stopwatch {
  std::function<double()> now;  ///< [s]; must never go back
  std::function<void(const char* stage, double milliseconds)> record;

  /// Runs `work`, records how long it took, and returns its result.
  template <typename Work>
  decltype(auto) Measure(const char* stage, const Work& work) const {
    const Lap lap{this, stage, now ? now() : 0};
    return work();
  }

 private:
  struct Lap {
    const Stopwatch* watch;
    const char* stage;
    double start;
    ~Lap() {
      if (watch->now) watch->record(stage, (watch->now() - start) * 1e3);
    }
  };
};

}  // namespace vismap
