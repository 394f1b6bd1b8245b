#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <cstddef>

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
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, grain < 1 ? 1 : grain),
                    [&](const tbb::blocked_range<size_t>& range) {
                      for (size_t i = range.begin(); i != range.end(); ++i) body(i);
                    });
}

}  // namespace vismap
