#pragma once

#include <cstddef>

namespace vismap {

/// Heap allocations of all libraries and threads of this process between Begin and End: malloc, new
/// and similar functions.
struct AllocationFigures {
  size_t largest = 0;  ///< single allocation [bytes]
  size_t peak = 0;     ///< largest total size at one time, minus that at Begin [bytes]
};

/// Measures allocations. One measurement at a time.
class AllocationMeter {
 public:
  static void Begin();
  static AllocationFigures End();
};

}  // namespace vismap
