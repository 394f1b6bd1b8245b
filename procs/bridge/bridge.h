#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bridge/bridge_end.h"
#include "bridge/source_sides.h"
#include "config/process_options.h"
#include "runtime/stop_signal.h"

namespace vismap {

/// The two buses that a bridge connects, and its name.
struct BridgePlace {
  LcmUrl local, remote;
  std::string name;                 ///< on both buses; "" = bridge-COMPUTER
  std::string channel_prefix = {};  ///< of our channels on both buses
};

/// Fails when a pattern of channels is not a valid regular expression.
Result<void> CheckOptions(const BridgeOptions& options);

/// Totals of one channel in one direction.
struct ForwardCounters {
  int64_t forwarded = 0, forwarded_bytes = 0;
  int64_t dropped = 0;   ///< the queue was full, because the other bus was slow or not connected
  int64_t replaced = 0;  ///< replaced by a newer message in the queue
  int64_t rejected = 0;  ///< not forwarded, larger than the channel allows
};

/// Forwards messages of the given channels between two buses, byte for byte. STATUS is always
/// forwarded in both directions. On a channel that is forwarded in both directions, a message is
/// forwarded only from the bus of its source, so that it cannot loop; a message without a vismap
/// head is not forwarded there. Only one bridge may connect the same two buses. While a bus is not
/// connected, messages to it wait in a bounded queue. While it is slow, the bridge stops reading
/// from the other bus, so that no message of a lossless channel is dropped.
class Bridge {
 public:
  /// Fails as CheckOptions and OpenBridgeEnd do.
  static Result<std::unique_ptr<Bridge>> Open(const BridgePlace& place,
                                              const BridgeOptions& options);

  /// Forwards messages until `stop` is requested. Publishes STATUS on both buses once a second.
  /// Calls `each_round` at least every quarter of a second, or after an attempt to connect, which
  /// may take a second per bus.
  void Run(const StopSignal& stop, const std::function<void()>& each_round);

  /// The counters of each channel, in alphabetical order.
  const std::map<std::string, ForwardCounters>& sent() const { return directions_[0].counters; }
  const std::map<std::string, ForwardCounters>& received() const { return directions_[1].counters; }

 private:
  struct Direction {
    const char* name = nullptr;
    BridgeSide side{};  ///< the bus from which the messages come
    BridgeEnd* from = nullptr;
    BridgeEnd* to = nullptr;
    /// Of the channels that are forwarded, by their names on the bus.
    std::map<std::string, ForwardCounters> counters;
  };

  Bridge(const BridgePlace& place, ChannelPolicies policies);
  void ServeOnce(const StopSignal& stop, int timeout_ms);
  void Forward(Direction& direction, const TcpqRecord& record);
  bool WouldLoop(const Direction& direction, const TcpqRecord& record);
  void PublishStatus();
  std::string StatusSentence() const;

  std::string name_, channel_prefix_;
  ChannelPolicies policies_;
  std::unique_ptr<BridgeEnd> local_, remote_;
  std::array<Direction, 2> directions_;
  SourceSides sides_;
  int64_t start_utime_ = 0;
  int64_t status_seq_ = 0;
};

}  // namespace vismap
