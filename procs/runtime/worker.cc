#include "runtime/worker.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>

#include "base/parallel.h"
#include "base/require.h"

namespace vismap {

Worker::Worker(Bus* bus) : event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  Require(event_ >= 0, "the system has a free file descriptor");
  bus->Watch(event_, [this] { TellDone(); });
  thread_ = std::thread([this] { Run(); });
}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    waiting_.clear();
  }
  changed_.notify_all();
  thread_.join();
  close(event_);
}

void Worker::Add(Task task) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(task));
  }
  changed_.notify_all();
}

void Worker::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
    if (ends_) return;
    Task task = std::move(waiting_.front());
    waiting_.pop_front();
    working_ = true;
    lock.unlock();
    try {
      InOneThread([&] { task.work(); });
    } catch (...) {
      task.thrown = std::current_exception();
    }
    task.work = nullptr;  // what it holds may be large
    lock.lock();
    AddFinished(std::move(task));
    working_ = false;
  }
}

void Worker::Post(std::function<void()> action) {
  const std::lock_guard lock(mutex_);
  AddFinished({nullptr, std::move(action), nullptr});
}

// The mutex must be locked.
void Worker::AddFinished(Task task) {
  finished_.push_back(std::move(task));
  const uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(event_, &one, sizeof(one));
  changed_.notify_all();
}

void Worker::TellDone() {
  uint64_t count = 0;
  [[maybe_unused]] const ssize_t bytes = read(event_, &count, sizeof(count));
  for (;;) {
    Task task;
    {
      const std::lock_guard lock(mutex_);
      if (finished_.empty()) return;
      task = std::move(finished_.front());
      finished_.pop_front();
    }
    if (task.thrown) std::rethrow_exception(task.thrown);
    task.done();
  }
}

void Worker::Finish() {
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return !finished_.empty() || (waiting_.empty() && !working_); });
      if (finished_.empty()) return;
    }
    TellDone();
  }
}

}  // namespace vismap
