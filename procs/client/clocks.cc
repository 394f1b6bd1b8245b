#include "client/clocks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "runtime/clock.h"

namespace vismap {
namespace {

constexpr int64_t kStepUs = 10000;  // a clock that jumps by more was set; less may be jitter [us]

struct BothClocks {
  double apart = 0;   // how long reading them took [s]
  int64_t utime = 0;  // [us]
  double seconds = 0;
};

// The process may be interrupted between two clocks.
BothClocks ReadBothClocks() {
  BothClocks best{std::numeric_limits<double>::infinity()};
  for (int i = 0; i < 3; ++i) {
    const double begin = MonotonicSeconds();
    const int64_t utime = WallUtime();
    const double end = MonotonicSeconds();
    if (end - begin < best.apart) best = {end - begin, utime, (begin + end) / 2};
  }
  return best;
}

}  // namespace

int64_t DeviceClock::ToUtime(double device_s) {
  const BothClocks now = ReadBothClocks();
  return ToUtime(device_s, now.utime, now.seconds);
}

int64_t DeviceClock::ToUtime(double device_s, int64_t arrival_utime, double arrival_s) {
  constexpr double kMost = 1e11;  // [s]
  if (!(std::abs(device_s) <= kMost)) {
    throw std::invalid_argument("the time stamp of the camera is " + std::to_string(device_s) +
                                "; expected seconds");
  }
  const int64_t arrival = std::llround(arrival_s * 1e6);
  const Moment now{std::llround(device_s * 1e6), arrival, arrival_utime - arrival};
  NoticeJumps(now);
  const int64_t offset = arrival - now.device;
  while (!smallest_.empty() && smallest_.back().second >= offset) smallest_.pop_back();
  smallest_.emplace_back(arrival, offset);
  while (smallest_.front().first < arrival - window_us_) smallest_.pop_front();
  const int64_t utime = now.device + smallest_.front().second + now.ahead - latency_us_;
  last_ = std::max(utime, last_ + 1);
  return last_;
}

void DeviceClock::NoticeJumps(const Moment& now) {
  const std::optional<Moment> before = std::exchange(before_, now);
  if (!before) return;
  if (now.device < before->device) {
    smallest_.clear();
    ++restarts_;
  }
  const bool arrival_went_back = now.arrival < before->arrival - kStepUs;
  if (arrival_went_back) smallest_.clear();
  if (arrival_went_back || now.ahead < before->ahead - kStepUs) {
    last_ = 0;
    ++steps_back_;
  }
}

bool FramePace::Takes(int64_t utime) {
  const auto time = static_cast<double>(utime);
  if (next_) {
    // A frame may come a little early, since cameras do not run evenly.
    const double early = *next_ - time - period_us_ / 4;
    if (early >= 0 && early <= 2 * period_us_) return false;
  }
  const bool anew = !next_ || time - *next_ > period_us_ || time < *next_ - 2 * period_us_;
  next_ = (anew ? time : *next_) + period_us_;
  return true;
}

}  // namespace vismap
