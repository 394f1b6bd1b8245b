#pragma once

#include <chrono>
#include <cstdint>

namespace vismap {

/// Wall clock [us since 1970], for the utime of status messages and requests. It never influences a
/// map.
inline int64_t WallUtime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Monotonic clock [s], for measuring durations.
inline double MonotonicSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace vismap
