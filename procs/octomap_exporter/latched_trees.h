#pragma once

#include <functional>
#include <string>
#include <vector>
#include <vismap/octree_t.hpp>

#include "runtime/bus.h"
#include "runtime/clock.h"

namespace vismap {

/// Publishes octrees and keeps the newest of each channel. LCM does not say when a reader comes, so
/// a tree is sent again when it was not sent for 1.5 s, or for longer when the trees are so large
/// that this would take more than a budget.
class LatchedTrees {
 public:
  static constexpr double kPeriod = 1.5;  ///< [s]
  using Clock = std::function<double()>;  ///< [s]; never goes back

  /// `budget`: bytes per second for all trees together; 0 = none is sent again. `bus` must outlive
  /// it.
  LatchedTrees(Bus* bus, double budget, Clock now = MonotonicSeconds)
      : bus_(bus), budget_(budget), now_(std::move(now)) {}

  /// Sends a tree with the present time as its published_utime. It replaces the one before.
  void Publish(const Channel& channel, octree_t tree);
  /// Sends what is due again.
  void Repeat();
  /// Forgets all trees, since they are of a map that is gone.
  void Clear();

  /// What was sent last on a channel; empty trees were not sent.
  struct Sent {
    Channel channel;
    octree_t tree;
    double at = 0;  ///< [s]
  };
  const std::vector<Sent>& sent() const { return sent_; }

 private:
  double RepeatPeriod() const;
  void Send(Sent* sent);

  Bus* bus_;
  double budget_;
  Clock now_;
  std::vector<Sent> sent_;  // one entry for each channel
};

}  // namespace vismap
