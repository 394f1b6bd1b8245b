#pragma once

#include <chrono>
#include <cstdint>

namespace vismap {

/// Wall clock [us since 1970], for stamping status and requests; never part of a result.
inline int64_t WallUtime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Seconds of a clock that only goes forward.
inline double MonotonicSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace vismap
