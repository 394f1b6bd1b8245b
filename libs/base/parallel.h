#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <cstddef>

#if defined(__SANITIZE_THREAD__)
#include <algorithm>
#include <atomic>
#include <thread>
#endif

namespace vismap {

/// Limits the threads that parallel loops may use, for as long as it lives.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads)
      : control_(tbb::global_control::max_allowed_parallelism,
                 static_cast<size_t>(threads < 1 ? 1 : threads)) {}

 private:
  tbb::global_control control_;
};

/// Calls `body(i)` once for every i in [0, count), in parallel. The bodies may write only to places
/// that belong to their own index, so that the result is the same for any number of threads.
/// `grain` = indices handed out at a time.
template <typename Body>
void ParallelFor(size_t count, size_t grain, const Body& body) {
  const size_t step = grain < 1 ? 1 : grain;
#if defined(__SANITIZE_THREAD__)
  // The thread sanitizer cannot see how TBB, which is not compiled with it, orders its threads: it
  // would report every loop. So these loops run in two threads that it knows.
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

/// Calls `body(from, to)` for every `size` indices of [0, count), the last time for what is left,
/// in parallel: for bodies that keep something from one index to the next. See ParallelFor.
template <typename Body>
void ParallelForGroups(size_t count, size_t size, const Body& body) {
  ParallelFor((count + size - 1) / size, 1, [&](size_t group) {
    const size_t from = group * size, left = count - from;
    body(from, from + (left < size ? left : size));
  });
}

}  // namespace vismap
