#pragma once

#include <algorithm>
#include <functional>
#include <utility>

#include "runtime/clock.h"

namespace vismap {

/// The largest share of its time that a process spends on work beside its frames, of each kind:
/// usually, and while the map is behind the cameras.
inline constexpr double kUsualShare = 0.2, kShareWhenBehind = 0.05;

/// The pause after work that took `seconds`, so that it takes at most this share of the time [s].
constexpr double PauseAfter(double seconds, double share) { return seconds * (1 / share - 1); }

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

  /// Does the work if it is due. The next time is one period after its end, or later, so that the
  /// work takes at most `share` of the time.
  template <typename Work>
  void RunIfDue(const Work& work, double share = kUsualShare) {
    const double start = now_();
    if (start < due_) return;
    work();
    const double end = now_();
    due_ = end + std::max(period_, PauseAfter(end - start, share));
  }

 private:
  double period_;
  Clock now_;
  double due_ = 0;
};

}  // namespace vismap
