#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>

#include "base/result.h"
#include "hub/client.h"
#include "hub/fault_injection.h"
#include "queueing/channel_policies.h"
#include "runtime/lcm_url.h"
#include "runtime/stop_signal.h"
#include "wire/channels.h"

namespace vismap {

struct HubOptions {
  TcpAddress listen{"127.0.0.1", 7700};  ///< port 0 = any free one
  std::string name;  ///< on the bus; empty = hub-COMPUTER-PORT, for hubs whose buses are bridged
  size_t queue_bytes = 256 * kMegabyte;         ///< may wait for a client, see MessageQueue
  size_t max_message_bytes = kMaxMessageBytes;  ///< a client that sends a larger one is cut off
  int socket_buffer_bytes = 0;  ///< SO_RCVBUF and SO_SNDBUF of the connections; 0 = the system's
  int max_clients = 256;
  double patience = 30;  ///< with a client that takes nothing while others wait for it [s]
  ChannelPolicies policies;
  FaultOptions faults;  ///< for tests
};

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
  /// Listens. Fails with the reason when the address is taken or not this computer's.
  static Result<std::unique_ptr<Hub>> Open(const HubOptions& options);
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
  explicit Hub(const HubOptions& options);
  Result<void> Listen();
  void ServeOnce(const StopSignal& stop, int timeout_ms);
  void Accept();
  void Read(Client& client);
  void HandleRecord(Client& client, TcpqRecord record);
  void Route(const TcpqRecord& record, Client* sender);
  void Count(const Client& client, const RoutedMessage& message, MessageQueue::Added added);
  void Disconnect(Client& client, const std::string& why);
  void DisconnectStalled();
  void RemoveDead();
  void PublishStatus();
  std::string StatusSentence() const;

  HubOptions options_;
  int socket_ = -1;
  uint16_t port_ = 0;
  std::list<std::shared_ptr<Client>> clients_;
  FaultInjection faults_;
  HubCounters counters_;
  int64_t start_utime_ = 0;
  int64_t status_seq_ = 0;
};

}  // namespace vismap
