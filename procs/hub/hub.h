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
#include "queueing/channel_policies.h"
#include "runtime/lcm_url.h"
#include "runtime/stop_signal.h"
#include "wire/channels.h"

namespace vismap {

/// Fails when the address or a pattern of channels cannot be understood.
Result<void> CheckOptions(const HubOptions& options);

/// Totals by name, of a bounded number of names.
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
  int64_t delivered = 0;  ///< messages queued for a client
  int64_t dropped = 0;    ///< messages a client missed because its queue was full
  int64_t replaced = 0;   ///< messages a client missed because a newer one took their place
  int64_t held_back = 0;  ///< times that a client had to stop sending because another one was slow
  int64_t dropped_on_purpose = 0;  ///< received and not passed on, see FaultOptions
  int64_t clients_accepted = 0, clients_cut_off = 0;
  NamedCounts dropped_by_channel, replaced_by_channel, dropped_by_client;
};

/// Passes messages between the clients of one bus, over TCP, in LCM's own tcpq protocol, so that
/// every LCM program can join. One thread, never blocked by a client: what a slow one cannot take
/// waits in its queue. What happens when that is full is a matter of the channel, see QueuePolicy:
/// for a lossless one the hub stops reading from those who publish it until there is room, or until
/// the slow client has taken nothing for the time of patience and is cut off. A client does not
/// wait for itself. Each client receives in the order of arrival here.
class Hub {
 public:
  /// Listens. `name` = on the bus; empty = hub-COMPUTER-PORT, so that hubs whose buses are bridged
  /// differ. `faults` = for tests. Fails as CheckOptions does, and with the reason when the address
  /// is taken or not this computer's.
  static Result<std::unique_ptr<Hub>> Open(const HubOptions& options, const std::string& name = "",
                                           const FaultOptions& faults = {});
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
  Hub(const HubOptions& options, const std::string& name, const FaultOptions& faults);
  Result<void> Listen(const TcpAddress& at);
  void ServeOnce(const StopSignal& stop, int timeout_ms);
  void Accept();
  void Read(Client& client);
  void Take(Client& client, TcpqRecord record);
  void Route(const TcpqRecord& record, Client* sender);
  void Count(const Client& client, const RoutedMessage& message, MessageQueue::Added added);
  void CutOff(Client& client, const std::string& why);
  void LetGoOfHung();
  void RemoveDead();
  void PublishStatus();
  std::string StatusSentence() const;

  HubOptions options_;
  size_t queue_bytes_;
  std::string name_;
  ChannelPolicies policies_;
  int socket_ = -1;
  uint16_t port_ = 0;
  std::list<std::shared_ptr<Client>> clients_;
  FaultInjection faults_;
  bool loses_messages_;  // on purpose
  HubCounters counters_;
  int64_t start_utime_ = 0;
  int64_t status_seq_ = 0;
};

}  // namespace vismap
