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
#include "runtime/stop_signal.h"

namespace vismap {

struct BridgeOptions {
  LcmUrl local, remote;
  std::string name;                  ///< on both buses; empty = bridge-COMPUTER
  std::vector<std::string> send;     ///< channels passed on from local to remote
  std::vector<std::string> receive;  ///< and from remote to local
  size_t queue_bytes = 0;            ///< may wait in each direction, see MessageQueue
  ChannelPolicies policies;
};

/// Totals of one channel in one direction.
struct ForwardCounters {
  int64_t forwarded = 0, forwarded_bytes = 0;
  int64_t dropped = 0;   ///< no room while the other bus was away or slow
  int64_t replaced = 0;  ///< a newer one went instead
  int64_t rejected = 0;  ///< larger than the channel allows
};

/// Passes messages of listed channels on between two buses, byte for byte; STATUS goes both ways
/// always. Messages of a channel that goes both ways are passed on only from the side where their
/// source lives, so that none goes round; what is not one of our messages is not passed on there.
/// Two buses must be joined by one bridge only. While a bus is away, messages to it wait in a
/// bounded queue; while it is slow, nothing is read from the other that would have to be dropped,
/// if the channel is lossless.
class Bridge {
 public:
  static Result<std::unique_ptr<Bridge>> Open(const BridgeOptions& options);

  /// Passes messages on until `stop` is requested. Publishes its STATUS on both buses once a
  /// second. Calls `each_round` at least every quarter of a second, but for the time that an
  /// attempt to connect takes.
  void Run(const StopSignal& stop, const std::function<void()>& each_round);

  /// Per channel, in alphabetical order.
  const std::map<std::string, ForwardCounters>& sent() const { return directions_[0].counters; }
  const std::map<std::string, ForwardCounters>& received() const { return directions_[1].counters; }

 private:
  struct Direction {
    const char* name = nullptr;
    BridgeSide side{};  ///< where the messages come from
    BridgeEnd* from = nullptr;
    BridgeEnd* to = nullptr;
    std::map<std::string, ForwardCounters> counters;  // of the listed channels
  };

  explicit Bridge(const BridgeOptions& options);
  void ServeOnce(const StopSignal& stop, int timeout_ms);
  void Forward(Direction& direction, const TcpqRecord& record);
  bool WouldLoop(const Direction& direction, const TcpqRecord& record);
  void PublishStatus();
  std::string StatusSentence() const;

  BridgeOptions options_;
  std::unique_ptr<BridgeEnd> local_, remote_;
  std::array<Direction, 2> directions_;
  SourceSides sides_;
  int64_t start_utime_ = 0;
  int64_t status_seq_ = 0;
};

}  // namespace vismap
