#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace vismap {

// What a camera driver needs besides the bus. The rules are those of the Python package.

/// Converts the time stamps of a camera to utime [us since 1970]. For use by one thread.
///
/// A frame arrives some time after it was taken, and that time varies. The smallest difference
/// between arrival and time stamp within a window is taken for the offset between the clocks, so
/// that the varying part disappears, and a slow drift is followed. Arrivals are measured by a clock
/// that is never set, so that the results follow at once when the wall clock is set, forward or
/// back. The results of one camera increase, as utime must, but when the wall clock is set back.
class DeviceClock {
 public:
  /// `latency_s`: the constant part of the time from exposure to arrival, if it is known [s].
  explicit DeviceClock(double window_s = 30, double latency_s = 0)
      : window_us_(static_cast<int64_t>(window_s * 1e6)),
        latency_us_(static_cast<int64_t>(latency_s * 1e6)) {}

  /// The time of a frame with the time stamp `device_s` [s] that arrives now. Must be given all
  /// frames, also those that are not published. Throws std::invalid_argument when it is not finite.
  int64_t ToUtime(double device_s);
  /// The same for a frame that arrived at `arrival_utime` by the wall clock [us] and at `arrival_s`
  /// by a clock that is never set [s].
  int64_t ToUtime(double device_s, int64_t arrival_utime, double arrival_s);

  int64_t restarts() const { return restarts_; }      ///< how often the camera's clock jumped back
  int64_t steps_back() const { return steps_back_; }  ///< how often the wall clock was set back

 private:
  struct Moment {
    int64_t device = 0, arrival = 0, ahead = 0;  // `ahead`: the wall clock minus arrival [us]
  };
  void NoticeJumps(const Moment& now);

  int64_t window_us_, latency_us_;
  std::deque<std::pair<int64_t, int64_t>> smallest_;  // arrival, offset [us]; offsets ascending
  std::optional<Moment> before_;
  int64_t last_ = 0;
  int64_t restarts_ = 0, steps_back_ = 0;
};

/// Lets at most so many frames per second through, evenly.
class FramePace {
 public:
  /// 0 = all frames go through.
  explicit FramePace(double rate_hz) : period_us_(rate_hz > 0 ? 1e6 / rate_hz : 0) {}

  /// Whether the frame of this time [us] goes through.
  bool Takes(int64_t utime);

 private:
  double period_us_;
  std::optional<double> next_;
};

/// A place for one value between two threads. A value that was not taken is replaced by the next
/// one, and counted.
template <typename Value>
class NewestValue {
 public:
  void Put(Value value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    skipped_ += value_.has_value() ? 1 : 0;
    value_ = std::move(value);
    changed_.notify_one();
  }

  /// Removes and returns the newest value; nullopt when none comes within `timeout_s` [s].
  std::optional<Value> Take(double timeout_s) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, std::chrono::duration<double>(timeout_s), [&] { return !!value_; });
    return std::exchange(value_, std::nullopt);
  }

  /// Values that were replaced before they were taken.
  int64_t skipped() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return skipped_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Value> value_;
  int64_t skipped_ = 0;
};

}  // namespace vismap
