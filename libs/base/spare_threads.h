#pragma once

#include "base/parallel.h"

namespace vismap {

/// Calls `body()` so that its parallel loops use, beside the calling thread, only threads that no
/// other loop wants. For long work beside something that is more urgent.
template <typename Body>
void InSpareThreads(const Body& body) {
  tbb::task_arena(tbb::task_arena::automatic, 1, tbb::task_arena::priority::low).execute(body);
}

}  // namespace vismap
