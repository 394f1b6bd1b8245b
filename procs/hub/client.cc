#include "hub/client.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "runtime/clock.h"
#include "wire/channels.h"
#include "wire/envelope.h"

namespace vismap {

HubClient::HubClient(Socket socket, const std::string& address, size_t max_message_bytes,
                     const QueueLimits& limits)
    : name(address), connection(max_message_bytes, limits) {
  connected_at = MonotonicSeconds();
  connection.Open(std::move(socket), RecordReader(TcpqMagic::kClient, max_message_bytes),
                  TcpqHello(TcpqMagic::kHub));
}

void HubClient::LearnName(const TcpqRecord& record, std::string_view channel_prefix) {
  if (named || NameOfOurs(record.name, channel_prefix) != kStatusChannel.name) return;
  const std::optional<MessageHead> head = PeekHead(record.data());
  if (!head || head->source.empty() || head->source.size() > 64) return;
  source = head->source;
  name = source + " (" + name + ")";
  named = true;
}

void HubClient::WaitFor(const std::shared_ptr<HubClient>& slow) {
  const bool known = std::any_of(waits_for.begin(), waits_for.end(),
                                 [&](const auto& entry) { return entry.lock() == slow; });
  if (!known) waits_for.push_back(slow);
}

bool HubClient::MustWait() {
  std::erase_if(waits_for, [](const std::weak_ptr<HubClient>& entry) {
    const std::shared_ptr<HubClient> slow = entry.lock();
    return slow == nullptr || slow->dead || !slow->critical || !slow->connection.queue().full();
  });
  return !waits_for.empty();
}

}  // namespace vismap
