#pragma once

#include <memory>
#include <string>
#include <vector>

#include "queueing/channel_patterns.h"
#include "queueing/queued_connection.h"

namespace vismap {

/// One client of the hub.
struct HubClient {
  HubClient(Socket socket, const std::string& address, size_t max_message_bytes,
            size_t queue_bytes);

  /// Learns who this is from a message that it publishes: a process says so on STATUS.
  void LearnName(const TcpqRecord& record);
  /// Messages to a client that is alive were too much for it; this one stops sending until there is
  /// room, or that one is gone.
  void WaitFor(const std::shared_ptr<HubClient>& slow);
  /// Whether it still has to wait for somebody.
  bool MustWait();

  std::string name;  ///< for people: address, and name on the bus where it has told it
  QueuedConnection connection;
  ChannelPatterns subscriptions;
  std::vector<std::weak_ptr<HubClient>> waits_for;
  bool named = false;
  bool dead = false;
};

}  // namespace vismap
