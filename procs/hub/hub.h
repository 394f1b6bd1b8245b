#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>

#include "base/result.h"
#include "config/process_options.h"
#include "hub/client.h"
#include "hub/fault_injection.h"
#include "hub/hold_budgets.h"
#include "hub/rejoin_backlog.h"
#include "queueing/channel_policies.h"
#include "runtime/lcm_url.h"
#include "runtime/stop_signal.h"
#include "wire/channels.h"

namespace vismap {

/// Fails when the address or a pattern of channels is not valid.
Result<void> CheckOptions(const HubOptions& options);

/// Counters by name. The number of names is bounded; further names are counted as "others".
class NamedCounts {
 public:
  void Add(const std::string& name);
  const std::map<std::string, int64_t>& all() const { return counts_; }
  int64_t of(const std::string& name) const;

 private:
  std::map<std::string, int64_t> counts_;
};

/// Totals since the hub was opened.
struct HubCounters {
  int64_t received = 0, received_bytes = 0;
  int64_t delivered = 0;           ///< messages queued for clients
  int64_t dropped = 0;             ///< messages not queued for a client because its queue was full
  int64_t replaced = 0;            ///< queued messages that were replaced by newer ones
  int64_t held_back = 0;           ///< how often a client had to wait because another one was slow
  int64_t dropped_on_purpose = 0;  ///< received but not forwarded, see FaultOptions
  int64_t clients_accepted = 0, clients_cut_off = 0;
  int64_t delivered_late = 0;  ///< messages that a client has received from RejoinBacklog
  int64_t held_back_ms = 0;    ///< time that publishers have waited
  NamedCounts dropped_by_channel, replaced_by_channel, dropped_by_client;
};

/// Forwards messages between the clients of one bus over TCP. It uses LCM's tcpq protocol, so that
/// every LCM program can connect. It has one thread, which no client can block: messages for a slow
/// client wait in the queue of that client. QueuePolicy decides what happens when this queue is
/// full. For a lossless channel and a critical process the hub stops reading from the publishers
/// until the queue has room, for a bounded time in total; other slow clients lose messages. A
/// client that subscribes within rejoin_s after the start of the hub receives what it has missed. A
/// client that falls behind by more than patience_s is disconnected. A client never waits for
/// itself. Each client receives messages in the order in which they arrived at the hub.
class Hub {
 public:
  /// Starts to listen. `name` is that on the bus; "" = hub-COMPUTER-PORT, which is unique also on
  /// bridged buses. `faults` is for tests. `channel_prefix`: of its STATUS; channels of ours with
  /// other prefixes are treated by their names as well, see NameOfOurs. Fails as CheckOptions does,
  /// and with the reason when the address is in use or does not belong to this computer.
  static Result<std::unique_ptr<Hub>> Open(const HubOptions& options, const std::string& name = "",
                                           const FaultOptions& faults = {},
                                           const std::string& channel_prefix = "");
  ~Hub();
  Hub(const Hub&) = delete;
  Hub& operator=(const Hub&) = delete;

  uint16_t port() const { return port_; }
  const HubCounters& counters() const { return counters_; }
  int client_count() const { return static_cast<int>(clients_.size()); }

  /// Serves until `stop` is requested. Publishes its own STATUS once a second. Calls `each_round`
  /// at least every quarter of a second.
  void Run(
      const StopSignal& stop, const std::function<void()>& each_round = [] {});

 private:
  using Client = HubClient;
  Hub(const HubOptions& options, const std::string& name, const FaultOptions& faults,
      const std::string& channel_prefix);
  Result<void> Listen(const TcpAddress& at);
  void ServeOnce(const StopSignal& stop, int timeout_ms);
  void Accept();
  void Read(Client& client);
  void HandleRecord(Client& client, TcpqRecord record);
  void Subscribe(Client& client, const std::string& pattern);
  void Route(const TcpqRecord& record, Client* sender);
  void Count(const Client& client, const RoutedMessage& message, MessageQueue::Added added);
  void Disconnect(Client& client, const std::string& why);
  void DisconnectLate();
  void DisconnectLargest();
  void ChargeHolds();
  void UpdateCritical(Client* client);
  bool MakeRoomForClient();
  void RemoveDead();
  void PublishStatus();
  std::string StatusSentence() const;

  HubOptions options_;
  size_t queue_bytes_, total_bytes_;
  std::string name_, channel_prefix_;
  ChannelPolicies policies_;
  ChannelPatterns critical_;  // names of processes
  int socket_ = -1;
  uint16_t port_ = 0;
  std::list<std::shared_ptr<Client>> clients_;
  FaultInjection faults_;
  bool loses_messages_;  // intentionally, for a test
  HoldBudgets budgets_;
  RejoinBacklog backlog_;
  double charged_at_ = 0;       // MonotonicSeconds
  double accept_again_at_ = 0;  // after the system had no descriptor left
  HubCounters counters_;
  int64_t start_utime_ = 0;
  int64_t status_seq_ = 0;
};

}  // namespace vismap
