#include "runtime/bus.h"

#include <poll.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/self_check.h"

namespace vismap {
namespace {

constexpr double kRejoinPeriod = 0.25;  // [s]
constexpr double kRound = 0.02;         // longest time for messages before timers run [s]
constexpr size_t kMaxTrackedSources = 1024;
constexpr int64_t kLargestGap = 1'000'000'000;  // a larger one is not a loss, see TrackSequence

}  // namespace

Bus::Bus(const BusOptions& options, LcmUrl url) : options_(options), url_(std::move(url)) {}
Bus::~Bus() = default;

Result<std::unique_ptr<Bus>> Bus::Open(const BusOptions& options) {
  signal(SIGPIPE, SIG_IGN);
  const Result<LcmUrl> url = ParseLcmUrl(options.url);
  if (!url) return tl::unexpected(url.error());
  std::unique_ptr<Bus> bus(new Bus(options, *url));
  WarnAboutBus(*url);
  if (const Result<void> joined = bus->JoinWithin(options.connect_timeout); !joined) {
    return tl::unexpected(joined.error());
  }
  return bus;
}

Result<void> Bus::JoinWithin(double timeout) {
  const double deadline = MonotonicSeconds() + timeout;
  bool told = false;
  for (;;) {
    Result<void> joined = Join();
    if (joined || url_.provider != "tcpq") return joined;
    if (MonotonicSeconds() >= deadline) {
      return Fail("there is no hub at " + url_.text + " (" + joined.error().message +
                  "); start one with: " + HubCommand(url_));
    }
    if (!told) LogInfo("waiting for the hub at " + url_.text);
    told = true;
    const StopSignal never;
    if ((options_.stop != nullptr ? *options_.stop : never).WaitFor(0.1))
      return Fail("stopped while waiting for the hub");
  }
}

Result<void> Bus::Join() {
  transport_.reset();
  Result<std::unique_ptr<Transport>> joined =
      url_.provider == "tcpq" ? OpenTcpqTransport(url_.hub, options_.stop) : OpenLcmTransport(url_);
  if (!joined) return tl::unexpected(joined.error());
  transport_ = std::move(*joined);
  for (const std::unique_ptr<Route>& route : routes_) {
    if (route->counts) transport_->Subscribe(route->channel.name);
  }
  if (!connected()) return Fail("the hub closed the connection");
  return {};
}

bool Bus::connected() const { return transport_ != nullptr && transport_->connected(); }

void Bus::Rejoin() {
  const double now = MonotonicSeconds();
  if (now < next_attempt_) return;
  if (transport_ != nullptr)
    LogWarning("the connection to the hub at " + url_.text + " was lost; trying to connect again");
  next_attempt_ = now + kRejoinPeriod;
  if (Join()) {
    ++reconnects_;
    LogInfo("connected to the hub at " + url_.text + " again");
  }
}

void Bus::AddRoute(std::unique_ptr<Route> route) {
  const std::string name = route->channel.name;
  route->counts = std::none_of(routes_.begin(), routes_.end(),
                               [&](const auto& r) { return r->channel.name == name; });
  counters_[name];
  if (route->counts && connected()) transport_->Subscribe(name);
  routes_.push_back(std::move(route));
}

void Bus::Dispatch(const std::string& channel, std::span<const uint8_t> bytes) {
  try {
    for (size_t i = 0; i < routes_.size(); ++i) {  // a handler may add routes
      Route& route = *routes_[i];
      if (channel == route.channel.name) Receive(route, bytes);
    }
  } catch (...) {
    thrown_ = std::current_exception();
  }
}

void Bus::Receive(Route& route, std::span<const uint8_t> bytes) {
  if (route.counts) {
    ChannelCounters& counters = counters_[route.channel.name];
    ++counters.received;
    counters.received_bytes += static_cast<int64_t>(bytes.size());
    // LCM may report a size of 4 GB for a packet that it misread, so a message above the limit is
    // not read at all.
    if (bytes.size() <= route.channel.max_bytes) TrackSequence(route, bytes);
  }
  if (route.delivery == Delivery::kEvery || bytes.size() > route.channel.max_bytes)
    return Deliver(route, bytes);
  if (route.has_newest && route.counts) ++counters_[route.channel.name].superseded;
  route.newest.assign(bytes.begin(), bytes.end());
  route.has_newest = true;
}

void Bus::TrackSequence(Route& route, std::span<const uint8_t> bytes) {
  const std::optional<MessageHead> head = PeekHead(bytes);
  // Not a message of this type: the handler will reject it.
  if (!head || head->fingerprint != route.fingerprint || head->seq < 0) return;
  if (route.last_seq.size() >= kMaxTrackedSources && !route.last_seq.contains(head->source)) return;
  const auto [entry, first] = route.last_seq.try_emplace(head->source, head->seq);
  // A smaller number means that the source was restarted. A gap above kLargestGap cannot come from
  // a process of vismap.
  const int64_t lost = head->seq - entry->second - 1;
  if (!first && lost > 0 && lost <= kLargestGap) {
    counters_[route.channel.name].lost += lost;
    LogWarningRateLimited(std::string("lost ") + route.channel.name,
                          std::string(route.channel.name) + ": " + FormatCount(lost, "message") +
                              " of " + head->source + " were lost before sequence number " +
                              std::to_string(head->seq));
  }
  entry->second = head->seq;
}

void Bus::Deliver(Route& route, std::span<const uint8_t> bytes) {
  const Result<void> handled = route.handle(bytes);
  if (handled) return;
  ++counters_[route.channel.name].rejected;
  LogWarningRateLimited(
      std::string("rejected ") + route.channel.name,
      std::string(route.channel.name) + ": a message was rejected: " + handled.error().message);
}

bool Bus::Send(const Channel& channel, const std::vector<uint8_t>& bytes) {
  ChannelCounters& counters = counters_[channel.name];
  const bool fits = bytes.size() <= channel.max_bytes;
  if (!fits) {
    LogWarningRateLimited(std::string("too large ") + channel.name,
                          std::string(channel.name) + ": a message of " +
                              FormatBytes(bytes.size()) + " was not sent; at most " +
                              FormatBytes(channel.max_bytes) + " are allowed");
  }
  if (!fits || !connected() || !transport_->Publish(channel.name, bytes)) {
    ++counters.unsent;
    return false;
  }
  ++counters.published;
  counters.published_bytes += static_cast<int64_t>(bytes.size());
  return true;
}

void Bus::Every(double period, std::function<void()> action) {
  timers_.push_back({period, MonotonicSeconds() + period, std::move(action)});
}

// Runs the timers that are due. Returns the time until the next one is due [s].
double Bus::RunTimers() {
  double wait = 3600;
  for (size_t i = 0; i < timers_.size(); ++i) {  // an action may add timers
    if (timers_[i].due <= MonotonicSeconds()) {
      timers_[i].due = MonotonicSeconds() + timers_[i].period;
      const std::function<void()> action = timers_[i].action;
      action();
    }
    wait = std::min(wait, timers_[i].due - MonotonicSeconds());
  }
  return std::max(wait, 0.0);
}

bool Bus::HandleWaiting() {
  const double end = MonotonicSeconds() + kRound;
  const Transport::Sink sink = [this](const std::string& channel, std::span<const uint8_t> bytes) {
    Dispatch(channel, bytes);
  };
  bool any = false;
  // Messages that were read before the connection ended are handled, too.
  while (transport_ != nullptr && !stop_requested() && transport_->Receive(sink)) {
    any = true;
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
    if (MonotonicSeconds() > end) break;
  }
  DeliverNewest();
  return any;
}

void Bus::DeliverNewest() {
  for (size_t i = 0; i < routes_.size(); ++i) {
    if (!routes_[i]->has_newest) continue;
    routes_[i]->has_newest = false;
    const std::vector<uint8_t> bytes = std::exchange(routes_[i]->newest, {});
    Deliver(*routes_[i], bytes);
  }
}

bool Bus::Spin(double timeout) {
  double wait = std::min(timeout, RunTimers());
  const bool pending = transport_ != nullptr && transport_->pending();
  if (!connected() && !pending) {
    Rejoin();
    wait = std::min(wait, kRejoinPeriod);
  }
  pollfd waiting[2] = {{options_.stop != nullptr ? options_.stop->fd() : -1, POLLIN, 0},
                       {connected() ? transport_->fd() : -1, POLLIN, 0}};
  poll(waiting, 2, pending ? 0 : static_cast<int>(std::ceil(wait * 1000)));
  return (pending || waiting[1].revents != 0) && HandleWaiting();
}

bool Bus::Run(const std::function<bool()>& finished) {
  while (!stop_requested()) {
    if (finished()) return true;
    Spin(0.1);
  }
  return false;
}

}  // namespace vismap
