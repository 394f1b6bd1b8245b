#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace vismap {

/// Finds the wrong times in a stream of items. From one item to the next, the sender's time may
/// advance by `slack` more than the receiver's clock, and go back by `slack`. An item whose time
/// differs more is held back until the next one comes. When the time of that one lies on the same
/// side, the sender's clock was set, or runs fast, and both are used. Else the time of the item was
/// wrong, and it is left out.
template <typename Item>
class TimeGate {
 public:
  struct Timed {
    Item item;
    int64_t utime = 0, received = 0;  ///< sender's and receiver's time, at least 0 [us]
    bool stepped_back = false;        ///< the sender's clock was set back before it
  };

  /// `slack` in microseconds.
  explicit TimeGate(int64_t slack) : slack_(slack) {}

  /// Takes the next item, and calls `use(Timed&&)` for each one whose time is right, in order.
  /// Returns true when the item before it is left out.
  template <typename Use>
  bool Add(Item item, int64_t utime, int64_t received, const Use& use) {
    Timed next{std::move(item), utime, received};
    const int side = SideOf(next);
    std::optional<Timed> held = std::exchange(held_, std::nullopt);
    const bool goes_on =
        held && side != 0 && side == held_side_ && (side < 0 || next.utime >= held->utime - slack_);
    const bool left_out = held && !goes_on;
    if (goes_on) {
      held->stepped_back = side < 0;
      use(std::move(*held));
    }
    sure_ = last_ && (side == 0 || goes_on);
    if (side != 0 && !goes_on) {
      held_ = std::move(next);
      held_side_ = side;
    } else {
      last_ = Times{next.utime, next.received};
      use(std::move(next));
    }
    return left_out;
  }

  /// Whether the time of the last item is surely right, since the one before agrees with it.
  bool sure() const { return sure_; }

  /// The end: uses the item that is held back.
  template <typename Use>
  void Finish(const Use& use) {
    if (std::optional<Timed> held = std::exchange(held_, std::nullopt)) use(std::move(*held));
  }

  /// The times go on from here; what is held back is dropped.
  void Restart(int64_t utime, int64_t received) {
    last_ = Times{utime, received};
    held_.reset();
  }

 private:
  struct Times {
    int64_t utime = 0, received = 0;
  };

  // 0: its time goes on from the last one; 1: it is too late; -1: it is too early.
  int SideOf(const Timed& next) const {
    if (!last_) return 0;
    const int64_t passed = std::max<int64_t>(0, next.received - last_->received);
    if (next.utime - last_->utime > passed + slack_) return 1;
    return next.utime < last_->utime - slack_ ? -1 : 0;
  }

  int64_t slack_;
  std::optional<Times> last_;  // of the last item used
  std::optional<Timed> held_;
  int held_side_ = 0;
  bool sure_ = false;
};

}  // namespace vismap
