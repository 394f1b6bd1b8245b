#pragma once

#include <cstddef>

namespace vismap {

/// What the heap gave out between Begin and End, by every library in this process: malloc, new and
/// their relatives, on all threads.
struct AllocationFigures {
  size_t largest = 0;  ///< single allocation [bytes]
  size_t peak = 0;     ///< most that was held at once beyond what was held at Begin [bytes]
};

/// Measures allocations. One measurement at a time.
class AllocationMeter {
 public:
  static void Begin();
  static AllocationFigures End();
};

}  // namespace vismap
