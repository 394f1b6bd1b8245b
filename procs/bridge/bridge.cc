#include "bridge/bridge.h"

#include <poll.h>

#include <algorithm>
#include <optional>
#include <set>

#include "base/format.h"
#include "base/printable.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/status.h"
#include "runtime/status_message.h"
#include "wire/channel_types.h"
#include "wire/channels.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

// The channels to forward by their names on the bus: ours have the prefix.
std::map<std::string, ForwardCounters> ZeroCounters(const std::vector<std::string>& channels,
                                                    const std::string& prefix) {
  std::map<std::string, ForwardCounters> counters = {{prefix + kStatusChannel.name, {}}};
  for (const std::string& channel : channels)
    counters[FindChannelType(channel) != nullptr ? prefix + channel : channel];
  return counters;
}

std::vector<std::string> Names(const std::map<std::string, ForwardCounters>& counters) {
  std::vector<std::string> names;
  for (const auto& [name, unused] : counters) names.push_back(name);
  return names;
}

Result<ChannelPolicies> PoliciesOf(const BridgeOptions& options, const std::string& prefix = "") {
  return ChannelPolicies::Make({options.lossless, options.latest, options.drop_newest, prefix});
}

}  // namespace

Result<void> CheckOptions(const BridgeOptions& options) {
  const Result<ChannelPolicies> policies = PoliciesOf(options);
  return policies ? Result<void>() : tl::unexpected(policies.error());
}

Bridge::Bridge(const BridgePlace& place, ChannelPolicies policies)
    : name_(place.name.empty() ? "bridge-" + HostName() : place.name),
      channel_prefix_(place.channel_prefix),
      policies_(std::move(policies)),
      start_utime_(WallUtime()) {}

Result<std::unique_ptr<Bridge>> Bridge::Open(const BridgePlace& place,
                                             const BridgeOptions& options) {
  const std::string& prefix = place.channel_prefix;
  Result<ChannelPolicies> policies = PoliciesOf(options, prefix);
  if (!policies) return tl::unexpected(policies.error());
  std::unique_ptr<Bridge> bridge(new Bridge(place, std::move(*policies)));
  Direction& send = bridge->directions_[0];
  Direction& receive = bridge->directions_[1];
  send = {"send", BridgeSide::kLocal, nullptr, nullptr, ZeroCounters(options.send, prefix)};
  receive = {"receive", BridgeSide::kRemote, nullptr, nullptr,
             ZeroCounters(options.receive, prefix)};
  const auto open = [&](const LcmUrl& url, const Direction& direction) {
    return OpenBridgeEnd(
        url, {Names(direction.counters), static_cast<size_t>(options.queue_mb) * kMegabyte});
  };
  Result<std::unique_ptr<BridgeEnd>> local = open(place.local, send);
  if (!local) return tl::unexpected(local.error());
  Result<std::unique_ptr<BridgeEnd>> remote = open(place.remote, receive);
  if (!remote) return tl::unexpected(remote.error());
  bridge->local_ = std::move(*local);
  bridge->remote_ = std::move(*remote);
  send.from = receive.to = bridge->local_.get();
  send.to = receive.from = bridge->remote_.get();
  return bridge;
}

void Bridge::Run(const StopSignal& stop, const std::function<void()>& each_round) {
  double next_status = 0;
  while (!stop.requested()) {
    each_round();
    for (BridgeEnd* end : {local_.get(), remote_.get()}) end->KeepConnected();
    if (MonotonicSeconds() >= next_status) {
      PublishStatus();
      next_status = MonotonicSeconds() + 1;
    }
    ServeOnce(stop, 250);
  }
}

void Bridge::ServeOnce(const StopSignal& stop, int timeout_ms) {
  pollfd waiting[3] = {{stop.fd(), POLLIN, 0}, {-1, 0, 0}, {-1, 0, 0}};
  for (size_t i = 0; i < directions_.size(); ++i) {
    const Direction& direction = directions_[i];
    // Do not read more for a queue that is full.
    const bool held = direction.to->connected() && direction.to->full();
    const int events = (held ? 0 : POLLIN) | (direction.from->wants_to_send() ? POLLOUT : 0);
    waiting[i + 1] = {direction.from->fd(), static_cast<short>(events), 0};
  }
  if (poll(waiting, 3, timeout_ms) <= 0) return;
  for (size_t i = 0; i < directions_.size(); ++i) {
    if ((waiting[i + 1].revents & ~POLLOUT) == 0) continue;
    Direction& direction = directions_[i];
    direction.from->Receive([&](const TcpqRecord& record) { Forward(direction, record); });
  }
  for (BridgeEnd* end : {local_.get(), remote_.get()}) end->Flush();
}

void Bridge::Forward(Direction& direction, const TcpqRecord& record) {
  const auto entry = direction.counters.find(record.name);
  if (entry == direction.counters.end()) return;
  ForwardCounters& counters = entry->second;
  const size_t most = MaxBytesOf(NameOfOurs(record.name, channel_prefix_));
  if (record.data().size() > most) {
    ++counters.rejected;
    LogWarningRateLimited("large " + record.name,
                          record.name + ": a message of " + FormatBytes(record.data().size()) +
                              " was not forwarded; at most " + FormatBytes(most) + " are allowed");
    return;
  }
  if (WouldLoop(direction, record)) return;
  switch (direction.to->Add(RouteMessage(record, &policies_))) {
    case MessageQueue::Added::kReplacedOlder:
      ++counters.replaced;
      return;
    case MessageQueue::Added::kDropped:
      ++counters.dropped;
      LogWarningRateLimited(
          "dropped " + record.name,
          record.name + ": a message to " + direction.to->url() + " was dropped: " +
              (direction.to->connected() ? "it is too slow"
                                         : "it has been unreachable for too long"));
      return;
    case MessageQueue::Added::kQueued:
      ++counters.forwarded;
      counters.forwarded_bytes += static_cast<int64_t>(record.data().size());
  }
}

bool Bridge::WouldLoop(const Direction& direction, const TcpqRecord& record) {
  const bool both_ways = directions_[0].counters.contains(record.name) &&
                         directions_[1].counters.contains(record.name);
  if (!both_ways) return false;
  const std::optional<MessageHead> head = PeekHead(record.data());
  return !head || head->source == name_ ||
         !sides_.LivesOn(direction.side, head->source, MonotonicSeconds());
}

void Bridge::PublishStatus() {
  process_status_t message = MakeStatus("bridge", start_utime_);
  message.seq = status_seq_++;
  message.source = name_;
  message.message = PrintableText(StatusSentence());
  message.state =
      StateName(message.message.empty() ? ProcessState::kRunning : ProcessState::kWaiting);
  for (const Direction& direction : directions_) {
    const std::string prefix = std::string(direction.name) + ".";
    for (const auto& [channel, counters] : direction.counters) {
      AddCounter(&message, prefix + channel + ".forwarded", counters.forwarded);
      AddCounter(&message, prefix + channel + ".forwarded_bytes", counters.forwarded_bytes);
      if (counters.dropped > 0)
        AddCounter(&message, prefix + channel + ".dropped", counters.dropped);
      if (counters.replaced > 0)
        AddCounter(&message, prefix + channel + ".replaced", counters.replaced);
      if (counters.rejected > 0)
        AddCounter(&message, prefix + channel + ".rejected", counters.rejected);
    }
    AddCounter(&message, prefix + "queued_bytes",
               static_cast<int64_t>(direction.to->queued_bytes()));
  }
  AddCounter(&message, "local.reconnects", local_->reconnects());
  AddCounter(&message, "remote.reconnects", remote_->reconnects());
  const RoutedMessage routed =
      RouteMessage(TcpqPublish(channel_prefix_ + kStatusChannel.name, Pack(message)), &policies_);
  for (BridgeEnd* end : {local_.get(), remote_.get()}) {
    end->Add(routed);
    end->Flush();
  }
}

std::string Bridge::StatusSentence() const {
  std::string text;
  for (const BridgeEnd* end : {local_.get(), remote_.get()}) {
    if (end->connected()) continue;
    text += (text.empty() ? "" : "; ") + ("no connection to " + end->url());
    if (!end->trouble().empty()) text += " (" + end->trouble() + ")";
  }
  return text;
}

}  // namespace vismap
