#include "hub/hub.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>
#include <utility>
#include <vector>

#include "base/format.h"
#include "base/printable.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/status.h"
#include "runtime/status_message.h"
#include "runtime/tcp_socket.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

// Limit per client and round, so that a busy client does not delay others [bytes].
constexpr size_t kReadPerTurn = size_t{2} << 20;

void SetOption(int fd, int level, int option, int value) {
  setsockopt(fd, level, option, &value, sizeof(value));
}

std::string AddressText(const sockaddr_in& address) {
  char text[INET_ADDRSTRLEN] = {};
  inet_ntop(AF_INET, &address.sin_addr, text, sizeof(text));
  return std::string(text) + ":" + std::to_string(ntohs(address.sin_port));
}

void AddCounts(process_status_t* message, const NamedCounts& counts, const std::string& what) {
  for (const auto& [name, count] : counts.all()) AddCounter(message, name + what, count);
}

Result<ChannelPolicies> PoliciesOf(const HubOptions& options, const std::string& prefix = "") {
  return ChannelPolicies::Make({options.lossless, options.latest, options.drop_newest, prefix});
}

Result<ChannelPatterns> CriticalOf(const HubOptions& options) {
  ChannelPatterns names;
  for (const std::string& pattern : options.critical) {
    if (const Result<void> added = names.Add(pattern); !added)
      return Fail("hub.critical (--critical): " + added.error().message);
  }
  return names;
}

// Whether a message is also delivered to clients that subscribe later. Requests, replies and
// commits are not: such a client would take them for replies to its own messages.
bool IsForLateReaders(std::string_view channel) {
  return channel != kMapRequestChannel.name && channel != kMapReplyChannel.name &&
         channel != kMapCommitChannel.name;
}

}  // namespace

void NamedCounts::Add(const std::string& name) {
  constexpr size_t kMaxNames = 64;
  const bool fits = counts_.contains(name) || counts_.size() < kMaxNames;
  ++counts_[fits ? name : "others"];
}

int64_t NamedCounts::of(const std::string& name) const {
  const auto found = counts_.find(name);
  return found == counts_.end() ? 0 : found->second;
}

Result<void> CheckOptions(const HubOptions& options) {
  if (const auto listen = ParseTcpAddress(options.listen); !listen)
    return Fail("hub.listen (--listen): " + listen.error().message);
  if (const auto policies = PoliciesOf(options); !policies) return tl::unexpected(policies.error());
  if (const auto critical = CriticalOf(options); !critical) return tl::unexpected(critical.error());
  return {};
}

Result<std::unique_ptr<Hub>> Hub::Open(const HubOptions& options, const std::string& name,
                                       const FaultOptions& faults,
                                       const std::string& channel_prefix) {
  if (const Result<void> checked = CheckOptions(options); !checked)
    return tl::unexpected(checked.error());
  std::unique_ptr<Hub> hub(new Hub(options, name, faults, channel_prefix));
  hub->policies_ = std::move(*PoliciesOf(options, channel_prefix));
  hub->critical_ = std::move(*CriticalOf(options));
  if (const auto listening = hub->Listen(*ParseTcpAddress(options.listen)); !listening)
    return Fail("cannot listen on " + options.listen + ": " + listening.error().message);
  if (name.empty()) hub->name_ = "hub-" + HostName() + "-" + std::to_string(hub->port_);
  hub->start_utime_ = WallUtime();
  return hub;
}

Hub::Hub(const HubOptions& options, const std::string& name, const FaultOptions& faults,
         const std::string& channel_prefix)
    : options_(options),
      queue_bytes_(static_cast<size_t>(options.queue_mb) * kMegabyte),
      total_bytes_(static_cast<size_t>(options.total_mb) * kMegabyte),
      name_(name),
      channel_prefix_(channel_prefix),
      faults_(faults),
      loses_messages_(faults.drop_fraction > 0),
      budgets_(options.max_hold_s),
      backlog_(MonotonicSeconds(), options.rejoin_s, queue_bytes_) {}

Hub::~Hub() {
  if (socket_ >= 0) close(socket_);
}

Result<void> Hub::Listen(const TcpAddress& at) {
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) return Fail(std::strerror(errno));
  SetOption(socket_, SOL_SOCKET, SO_REUSEADDR, 1);
  if (options_.socket_buffer_bytes > 0) {  // before listen(), so that connections inherit it
    SetOption(socket_, SOL_SOCKET, SO_RCVBUF, options_.socket_buffer_bytes);
    SetOption(socket_, SOL_SOCKET, SO_SNDBUF, options_.socket_buffer_bytes);
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(at.port);
  inet_pton(AF_INET, at.host.c_str(), &address.sin_addr);
  if (bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0 ||
      listen(socket_, 64) != 0) {
    return Fail(std::strerror(errno));
  }
  socklen_t size = sizeof(address);
  getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  return {};
}

void Hub::Run(const StopSignal& stop, const std::function<void()>& each_round) {
  double next_status = 0;
  while (!stop.requested()) {
    if (MonotonicSeconds() >= next_status) {
      PublishStatus();
      next_status = MonotonicSeconds() + 1;
    }
    ServeOnce(stop, 250);
    each_round();
  }
}

void Hub::ServeOnce(const StopSignal& stop, int timeout_ms) {
  const bool accepts = MonotonicSeconds() >= accept_again_at_;
  std::vector<pollfd> waiting = {{stop.fd(), POLLIN, 0}, {accepts ? socket_ : -1, POLLIN, 0}};
  std::vector<std::shared_ptr<Client>> polled(clients_.begin(), clients_.end());
  for (const std::shared_ptr<Client>& client : polled) {
    const int events =
        (client->MustWait() ? 0 : POLLIN) | (client->connection.wants_to_send() ? POLLOUT : 0);
    waiting.push_back({client->connection.fd(), static_cast<short>(events), 0});
  }
  if (poll(waiting.data(), waiting.size(), timeout_ms) > 0) {
    for (size_t i = 0; i < polled.size(); ++i) {
      if ((waiting[i + 2].revents & ~POLLOUT) != 0) Read(*polled[i]);
    }
    for (const std::shared_ptr<Client>& client : polled) client->connection.Flush();
    if (waiting[1].revents != 0) Accept();
  }
  backlog_.Expire(MonotonicSeconds());
  ChargeHolds();
  DisconnectLate();
  DisconnectLargest();
  RemoveDead();
}

void Hub::Accept() {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  Socket socket(
      accept4(socket_, reinterpret_cast<sockaddr*>(&address), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.open()) {
    if (errno != EMFILE && errno != ENFILE && errno != ENOBUFS && errno != ENOMEM) return;
    LogWarningRateLimited("descriptors", std::string("no client can connect now: ") +
                                             std::strerror(errno) + "; trying again in a second");
    accept_again_at_ = MonotonicSeconds() + 1;
    return;
  }
  const std::string name = AddressText(address);
  if (client_count() >= options_.max_clients && !MakeRoomForClient()) {
    ++counters_.clients_cut_off;
    LogWarningRateLimited("full", name + " was refused: there are already " +
                                      std::to_string(client_count()) + " clients");
    return;
  }
  TuneTcp(socket.fd());
  ++counters_.clients_accepted;
  LogDebug(name + " connected");
  auto client = std::make_shared<Client>(std::move(socket), name, kMaxMessageBytes,
                                         QueueLimits{queue_bytes_, options_.max_wait_s});
  client->number = counters_.clients_accepted;
  client->connection.Flush();
  clients_.push_back(std::move(client));
}

// Disconnects the oldest client that has had enough time to subscribe or publish and did neither,
// to make room for a new one.
bool Hub::MakeRoomForClient() {
  const auto idle = std::find_if(clients_.begin(), clients_.end(), [this](const auto& client) {
    const double age = MonotonicSeconds() - client->connected_at;
    return !client->active && age > options_.greeting_s;
  });
  if (idle == clients_.end()) return false;
  Disconnect(**idle, "had neither subscribed nor published, and there are too many clients");
  RemoveDead();
  return true;
}

void Hub::UpdateCritical(Client* client) {
  client->critical = !client->source.empty() && critical_.Match(client->source) &&
                     budgets_.MayHold(client->source);
}

void Hub::Read(Client& client) {
  if (client.dead) return;
  const Result<void> read = client.connection.Read(
      kReadPerTurn, [&](TcpqRecord record) { HandleRecord(client, std::move(record)); });
  if (read || client.dead) return;
  if (read.error().message.empty()) {
    client.dead = true;
    LogDebug(client.name + " disconnected");
  } else {
    Disconnect(client, read.error().message);
  }
}

void Hub::Disconnect(Client& client, const std::string& why) {
  client.dead = true;
  ++counters_.clients_cut_off;
  LogWarningRateLimited("disconnected", client.name + " " + why + "; it was disconnected");
}

void Hub::HandleRecord(Client& client, TcpqRecord record) {
  client.active = true;
  switch (record.kind) {
    case TcpqRecord::Kind::kPublish:
      ++counters_.received;
      counters_.received_bytes += static_cast<int64_t>(record.bytes->size());
      client.LearnName(record, channel_prefix_);
      UpdateCritical(&client);
      if (faults_.Drops(record.name)) {
        ++counters_.dropped_on_purpose;
        return;
      }
      return Route(record, &client);
    case TcpqRecord::Kind::kSubscribe:
      return Subscribe(client, record.name);
    case TcpqRecord::Kind::kUnsubscribe:
      client.has_unsubscribed = true;
      return client.subscriptions.Remove(record.name);
  }
}

void Hub::Subscribe(Client& client, const std::string& pattern) {
  ChannelPatterns added;
  Result<void> valid = added.Add(pattern);
  if (valid && !client.has_unsubscribed) {  // else it may have had the messages before
    const auto missed = [&](const std::string& channel) {
      return added.Match(channel) && !client.subscriptions.Match(channel);
    };
    backlog_.Replay(&client, missed, [&](const RoutedMessage& message) {
      ++counters_.delivered_late;
      Count(client, message, client.connection.Add(message, false));
    });
  }
  if (valid) valid = client.subscriptions.Add(pattern);
  if (!valid)
    Disconnect(client, "sent a subscription that cannot be used: " + valid.error().message);
}

void Hub::Route(const TcpqRecord& record, Client* sender) {
  RoutedMessage message = RouteMessage(record, &policies_);
  // A program that uses the name of another one does not replace the waiting messages of that one.
  if (sender != nullptr) message.source += "\n" + std::to_string(sender->number);
  if (sender != nullptr && IsForLateReaders(NameOfOurs(record.name, channel_prefix_)))
    backlog_.Keep(message, sender->shared_from_this(), MonotonicSeconds());
  for (const std::shared_ptr<Client>& client : clients_) {
    if (client->dead || !client->subscriptions.Match(record.name)) continue;
    // A client does not wait for itself, the hub (no sender) never waits, and no client waits
    // for one that is not critical.
    const bool sender_waits = sender != nullptr && sender != client.get() && client->critical;
    Count(*client, message, client->connection.Add(message, sender_waits));
    // Only the sender of a lossless message has to wait for a full queue.
    if (!sender_waits || message.policy != QueuePolicy::kLossless)
      continue;  // dropped if it did not fit
    if (!client->connection.queue().full()) continue;
    if (!sender->MustWait()) ++counters_.held_back;
    sender->WaitFor(client);
  }
}

void Hub::Count(const Client& client, const RoutedMessage& message, MessageQueue::Added added) {
  switch (added) {
    case MessageQueue::Added::kQueued:
      ++counters_.delivered;
      return;
    case MessageQueue::Added::kReplacedOlder:
      ++counters_.replaced;
      counters_.replaced_by_channel.Add(message.channel);
      return;
    case MessageQueue::Added::kDropped:
      ++counters_.dropped;
      counters_.dropped_by_channel.Add(message.channel);
      counters_.dropped_by_client.Add(client.name);
      LogWarningRateLimited("slow", client.name + " is too slow: its queue of " +
                                        FormatBytes(queue_bytes_) + " is full, so a message of " +
                                        message.channel + " was dropped");
  }
}

void Hub::ChargeHolds() {
  const double now = MonotonicSeconds();
  const double seconds = charged_at_ > 0 ? now - charged_at_ : 0;
  charged_at_ = now;
  budgets_.Refill(seconds);
  std::set<std::string> held_for;
  for (const std::shared_ptr<Client>& client : clients_) {
    if (!client->MustWait()) continue;
    counters_.held_back_ms += static_cast<int64_t>(seconds * 1e3);
    for (const std::weak_ptr<Client>& entry : client->waits_for) {
      if (const std::shared_ptr<Client> slow = entry.lock()) held_for.insert(slow->source);
    }
  }
  for (const std::string& name : held_for) budgets_.Charge(name, seconds);
  for (const std::shared_ptr<Client>& client : clients_) UpdateCritical(client.get());
}

void Hub::DisconnectLate() {
  constexpr double kSlowestLink = 65536;  // [bytes/s] of a large message
  for (const std::shared_ptr<Client>& client : clients_) {
    const QueuedConnection& connection = client->connection;
    if (connection.SecondsBehind() > options_.patience_s) {
      Disconnect(*client,
                 "is " + FormatDuration(connection.SecondsBehind()) + " behind with reading");
    } else if (!connection.has_greeting() &&
               connection.SecondsIncomplete(kSlowestLink) > options_.greeting_s) {
      Disconnect(*client, "has not sent the greeting of LCM's tcpq protocol");
    } else if (connection.SecondsIncomplete(kSlowestLink) > options_.patience_s &&
               !client->MustWait()) {
      Disconnect(*client, "has sent the beginning of a message, but not the rest");
    }
  }
}

// Bounds the total size of all queued and incomplete messages: disconnects the client with the
// largest share.
void Hub::DisconnectLargest() {
  size_t total = 0;
  Client* largest = nullptr;
  for (const std::shared_ptr<Client>& client : clients_) {
    if (client->dead) continue;
    const size_t bytes = client->connection.buffered_bytes();
    total += bytes;
    if (largest == nullptr || bytes > largest->connection.buffered_bytes()) largest = client.get();
  }
  if (total <= total_bytes_ || largest == nullptr) return;
  Disconnect(*largest, "had " + FormatBytes(largest->connection.buffered_bytes()) +
                           " waiting, and all clients together more than " +
                           FormatBytes(total_bytes_));
}

void Hub::RemoveDead() {
  clients_.remove_if([](const std::shared_ptr<Client>& client) {
    return client->dead || !client->connection.open();
  });
}

void Hub::PublishStatus() {
  process_status_t message = MakeStatus("hub", start_utime_);
  message.seq = status_seq_++;
  message.source = name_;
  message.state = StateName(ProcessState::kRunning);
  message.message = PrintableText(StatusSentence());
  AddCounter(&message, "clients", client_count());
  AddCounter(&message, "clients_accepted", counters_.clients_accepted);
  AddCounter(&message, "clients_cut_off", counters_.clients_cut_off);
  AddCounter(&message, "received", counters_.received);
  AddCounter(&message, "received_bytes", counters_.received_bytes);
  AddCounter(&message, "delivered", counters_.delivered);
  AddCounter(&message, "delivered_late", counters_.delivered_late);
  AddCounter(&message, "backlog_left_out", backlog_.dropped());
  AddCounter(&message, "dropped", counters_.dropped);
  AddCounter(&message, "held_back", counters_.held_back);
  AddCounter(&message, "held_back_ms", counters_.held_back_ms);
  size_t queued = backlog_.bytes();
  for (const std::shared_ptr<Client>& client : clients_) {
    queued += client->connection.buffered_bytes();
  }
  AddCounter(&message, "queued_bytes", static_cast<int64_t>(queued));
  if (loses_messages_) {
    AddCounter(&message, "dropped_on_purpose", counters_.dropped_on_purpose);
  }
  AddCounts(&message, counters_.dropped_by_channel, ".dropped");
  AddCounts(&message, counters_.replaced_by_channel, ".replaced");
  AddCounts(&message, counters_.dropped_by_client, ": dropped");
  Route(TcpqPublish(channel_prefix_ + kStatusChannel.name, Pack(message)), nullptr);
  for (const std::shared_ptr<Client>& client : clients_) client->connection.Flush();
}

std::string Hub::StatusSentence() const {
  for (const std::shared_ptr<Client>& client : clients_) {
    for (const std::weak_ptr<Client>& entry : client->waits_for) {
      const std::shared_ptr<Client> slow = entry.lock();
      if (slow != nullptr) return slow->name + " is slow, so " + client->name + " has to wait";
    }
  }
  return loses_messages_ ? "loses messages intentionally (--drop-fraction)" : "";
}

}  // namespace vismap
