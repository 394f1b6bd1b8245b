#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "runtime/bus.h"

namespace vismap {

/// A thread that does long work beside the thread of a Bus, one piece after the other, in their
/// order. Parallel loops of the work use this thread only, so that those of the bus's thread keep
/// theirs.
class Worker {
 public:
  /// `bus` must outlive it.
  explicit Worker(Bus* bus);
  /// Waits for the work that has begun; what has not begun is dropped.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Lets the thread call `work`, and then Spin of the bus call `done` with what it returned. An
  /// exception of `work` leaves Spin. `work` must not touch what the thread of the bus changes.
  template <typename Work, typename Done>
  void Start(Work work, Done done) {
    using Value = decltype(work());
    const auto value = std::make_shared<std::unique_ptr<Value>>();
    Add({[work = std::move(work), value] { *value = std::make_unique<Value>(work()); },
         [done = std::move(done), value] { done(std::move(**value)); }, nullptr});
  }

  /// Lets Spin of the bus call `action`; for work that has something to say before its end.
  void Post(std::function<void()> action);

  /// Waits until all work is done, and calls `done` of each.
  void Finish();

 private:
  struct Task {
    std::function<void()> work, done;
    std::exception_ptr thrown;
  };

  void Add(Task task);
  void Run();
  void AddFinished(Task task);
  void TellDone();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> waiting_, finished_;
  bool working_ = false, ends_ = false;
  int event_ = -1;  // readable when a task has finished
  std::thread thread_;
};

}  // namespace vismap
