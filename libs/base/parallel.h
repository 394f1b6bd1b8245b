#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

#if defined(__SANITIZE_THREAD__)
#include <algorithm>
#include <atomic>
#include <thread>
#endif

namespace vismap {

/// Limits the number of threads of parallel loops during its own lifetime.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads)
      : control_(tbb::global_control::max_allowed_parallelism,
                 static_cast<size_t>(threads < 1 ? 1 : threads)) {}

 private:
  tbb::global_control control_;
};

/// Calls `body(i)` once for every i in [0, count), in parallel. A call may write only to data of
/// its own index, so that the result is the same for any number of threads. `grain`: how many
/// indices a thread gets at a time.
template <typename Body>
void ParallelFor(size_t count, size_t grain, const Body& body) {
  const size_t step = grain < 1 ? 1 : grain;
#if defined(__SANITIZE_THREAD__)
  // TBB is not compiled with the thread sanitizer, which therefore cannot see how TBB orders its
  // threads and would report every loop. So the loop runs in two threads of its own.
  std::atomic<size_t> next = 0;
  const auto work = [&] {
    for (size_t from; (from = next.fetch_add(step)) < count;) {
      for (size_t i = from; i != std::min(from + step, count); ++i) body(i);
    }
  };
  std::thread other(work);
  work();
  other.join();
#else
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, step),
                    [&](const tbb::blocked_range<size_t>& range) {
                      for (size_t i = range.begin(); i != range.end(); ++i) body(i);
                    });
#endif
}

/// Calls `body(from, to)` in parallel for groups of `size` indices of [0, count); the last group
/// may be smaller. For bodies that reuse something from one index for the next. See ParallelFor.
template <typename Body>
void ParallelForGroups(size_t count, size_t size, const Body& body) {
  ParallelFor((count + size - 1) / size, 1, [&](size_t group) {
    const size_t from = group * size, left = count - from;
    body(from, from + (left < size ? left : size));
  });
}

/// Calls `body()` so that its parallel loops use only the calling thread. For long work beside
/// something that must not wait for threads.
template <typename Body>
void InOneThread(const Body& body) {
  tbb::task_arena(1).execute(body);
}

}  // namespace vismap
