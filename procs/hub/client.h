#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "queueing/channel_patterns.h"
#include "queueing/queued_connection.h"

namespace vismap {

/// One client of the hub.
struct HubClient : std::enable_shared_from_this<HubClient> {
  HubClient(Socket socket, const std::string& address, size_t max_message_bytes,
            const QueueLimits& limits);

  /// Sets the name of this client if the record is its STATUS message, which has the name of the
  /// process.
  void LearnName(const TcpqRecord& record, std::string_view channel_prefix);
  /// Stops reading from this client until the queue of `slow` has room again or `slow` has gone.
  void WaitFor(const std::shared_ptr<HubClient>& slow);
  /// Whether this client still has to wait for a slow one, so that the hub must not read from it.
  bool MustWait();

  std::string source;  ///< its name on the bus; "" = not yet known
  std::string name;    ///< for log lines: its address and, when known, its name on the bus
  QueuedConnection connection;
  ChannelPatterns subscriptions;
  std::vector<std::weak_ptr<HubClient>> waits_for;  ///< the slow clients, see WaitFor
  bool named = false;                               ///< `name` has its name on the bus
  bool dead = false;                                ///< disconnected, will be removed
  double connected_at = 0;                          // MonotonicSeconds
  int64_t number = 0;                               ///< clients are counted from 1
  bool has_unsubscribed = false;
  bool active = false;    ///< has subscribed or published
  bool critical = false;  ///< publishers may wait for it
};

}  // namespace vismap
