#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <string>

#include "base/result.h"
#include "hub/fault_injection.h"
#include "hub/subscriptions.h"
#include "runtime/lcm_url.h"
#include "runtime/stop_signal.h"
#include "runtime/tcpq_records.h"
#include "wire/channels.h"

namespace vismap {

struct HubOptions {
  TcpAddress listen{"127.0.0.1", 7700};  ///< port 0 = any free one
  size_t queue_bytes = 256 * kMegabyte;  ///< a client that lets more wait loses the newest messages
  size_t max_message_bytes = kMaxMessageBytes;  ///< a client that sends a larger one is cut off
  int socket_buffer_bytes = 0;  ///< SO_RCVBUF and SO_SNDBUF of the connections; 0 = the system's
  int max_clients = 256;
  FaultOptions faults;  ///< for tests
};

/// Totals since the hub was opened.
struct HubCounters {
  int64_t received = 0, received_bytes = 0;
  int64_t delivered = 0;           ///< messages queued for a client
  int64_t dropped = 0;             ///< messages a client missed because its queue was full
  int64_t dropped_on_purpose = 0;  ///< received and not passed on, see FaultOptions
  int64_t clients_accepted = 0, clients_cut_off = 0;
};

/// Passes messages between the clients of one bus, over TCP, in LCM's own tcpq protocol, so that
/// every LCM program can join. One thread, never blocked by a client: what a slow one cannot take
/// waits in its queue, up to queue_bytes; then it loses the newest messages, which is counted. Each
/// client receives in the order of arrival here.
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
  struct Client;
  explicit Hub(const HubOptions& options);
  Result<void> Listen();
  void ServeOnce(const StopSignal& stop, int timeout_ms);
  void Accept();
  void Read(Client& client);
  void Take(Client& client, TcpqRecord record);
  void Route(const std::string& channel, const SharedBytes& bytes);
  void Queue(Client& client, const SharedBytes& bytes);
  void Flush(Client& client);
  void RemoveDead();
  void PublishStatus();

  HubOptions options_;
  int socket_ = -1;
  uint16_t port_ = 0;
  std::list<std::unique_ptr<Client>> clients_;
  FaultInjection faults_;
  HubCounters counters_;
  int64_t start_utime_ = 0;
  int64_t status_seq_ = 0;
};

}  // namespace vismap
