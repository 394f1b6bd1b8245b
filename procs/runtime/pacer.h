#pragma once

#include <algorithm>
#include <functional>
#include <utility>

#include "runtime/clock.h"

namespace vismap {

/// Says when work that is repeated is due again. It is due at once, and then once per period.
class Pacer {
 public:
  using Clock = std::function<double()>;  ///< [s]; never goes back

  /// `period` in seconds.
  explicit Pacer(double period, Clock now = MonotonicSeconds)
      : period_(period), now_(std::move(now)) {}

  bool due() const { return now_() >= due_; }
  /// The work was done: it is due again after one period.
  void Restart() { due_ = now_() + period_; }

  /// Does the work if it is due. The next time is one period after its end, or four times as long
  /// as the work took, if that is longer: so the work takes at most a fifth of the time.
  template <typename Work>
  void RunIfDue(const Work& work) {
    const double start = now_();
    if (start < due_) return;
    work();
    const double end = now_();
    due_ = end + std::max(period_, 4 * (end - start));
  }

 private:
  double period_;
  Clock now_;
  double due_ = 0;
};

}  // namespace vismap
