#include "runtime/bus.h"

#include <signal.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/format.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/self_check.h"

namespace vismap {
namespace {

constexpr double kRejoinPeriod = 0.25;  // [s]
constexpr double kRound = 0.02;         // longest time for messages before timers run [s]
constexpr double kUrgentRound = 0.005;  // longest time for urgent messages between two others [s]
constexpr size_t kMostWaitToBeSent = 64 * kMegabyte;  // see SendByThread
constexpr size_t kMaxTrackedSources = 1024, kMaxTrackedName = 256;
constexpr int64_t kLargestGap = 1'000'000;  // a larger one is not a loss, see TrackSequence

}  // namespace

Bus::Bus(const BusOptions& options, LcmUrl url) : options_(options), url_(std::move(url)) {}
Bus::~Bus() = default;

Result<std::unique_ptr<Bus>> Bus::Open(const BusOptions& options) {
  signal(SIGPIPE, SIG_IGN);
  const Result<LcmUrl> url = ParseLcmUrl(options.url);
  if (!url) return tl::unexpected(url.error());
  if (const auto checked = CheckChannelPrefix(options.channel_prefix); !checked)
    return tl::unexpected(checked.error());
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
  urgent_.reset();
  JoinUrgent();
  for (const std::unique_ptr<Route>& route : routes_) {
    if (route->counts && !IsUrgent(*route)) Subscribe(transport_.get(), route->channel);
  }
  if (!connected()) return Fail("the hub closed the connection");
  return {};
}

// Without a hub, one connection serves all channels.
bool Bus::IsUrgent(const Route& route) const {
  return route.delivery == Delivery::kUrgent && url_.provider == "tcpq";
}

bool Bus::HasUrgentRoutes() const {
  return std::any_of(routes_.begin(), routes_.end(),
                     [this](const auto& route) { return IsUrgent(*route); });
}

// Opens the connection for urgent channels. It may end without the other one, since a hub cuts it
// off when too many messages wait on it; later calls open it again.
void Bus::JoinUrgent() {
  const bool joined = urgent_ != nullptr && urgent_->connected();
  const double now = MonotonicSeconds();
  if (joined || !HasUrgentRoutes() || now < next_urgent_attempt_) return;
  next_urgent_attempt_ = now + kRejoinPeriod;
  auto opened = OpenTcpqTransport(url_.hub, options_.stop);
  if (!opened) return;
  urgent_ = std::move(*opened);
  for (const std::unique_ptr<Route>& route : routes_) {
    if (route->counts && IsUrgent(*route)) Subscribe(urgent_.get(), route->channel);
  }
}

bool Bus::connected() const { return transport_ != nullptr && transport_->connected(); }

void Bus::Rejoin() {
  const double now = MonotonicSeconds();
  if (now < next_attempt_) return;
  if (transport_ != nullptr) {
    LogWarningRateLimited("connection", "the connection to the hub at " + url_.text +
                                            " was lost; trying to connect again");
  }
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
  const bool urgent = IsUrgent(*route);
  routes_.push_back(std::move(route));
  if (!connected() || !routes_.back()->counts) return;
  if (!urgent) return Subscribe(transport_.get(), routes_.back()->channel);
  urgent_.reset();  // it is opened for all urgent channels
  next_urgent_attempt_ = 0;
  JoinUrgent();
}

void Bus::Subscribe(Transport* transport, const Channel& channel) const {
  transport->Subscribe(ExpressionFor(options_.channel_prefix + channel.name));
}

void Bus::Dispatch(const std::string& on_bus, std::span<const uint8_t> bytes) {
  const std::optional<std::string> channel = WithoutPrefix(on_bus, options_.channel_prefix);
  if (!channel) return;
  try {
    for (size_t i = 0; i < routes_.size(); ++i) {  // a handler may add routes
      Route& route = *routes_[i];
      if (*channel == route.channel.name) Receive(route, bytes);
    }
  } catch (...) {
    thrown_ = std::current_exception();
  }
}

void Bus::Receive(Route& route, std::span<const uint8_t> bytes) {
  if (route.delivery != Delivery::kUrgent) last_work_ = MonotonicSeconds();
  if (route.counts) {
    ChannelCounters& counters = counters_[route.channel.name];
    ++counters.received;
    counters.received_bytes += static_cast<int64_t>(bytes.size());
    // LCM may report a size of 4 GB for a packet that it misread, so a message above the limit is
    // not read at all.
    if (bytes.size() <= route.channel.max_bytes) TrackSequence(route, bytes);
  }
  if (route.delivery != Delivery::kLatest || bytes.size() > route.channel.max_bytes)
    return Deliver(route, bytes);
  if (route.has_newest && route.counts) ++counters_[route.channel.name].superseded;
  route.newest.assign(bytes.begin(), bytes.end());
  route.has_newest = true;
}

void Bus::TrackSequence(Route& route, std::span<const uint8_t> bytes) {
  const std::optional<MessageHead> head = PeekHead(bytes);
  // Not a message of this type: the handler will reject it.
  if (!head || head->fingerprint != route.fingerprint || head->seq < 0) return;
  if (head->source.size() > kMaxTrackedName) return;
  if (route.last_seq.size() >= kMaxTrackedSources && !route.last_seq.contains(head->source)) return;
  const auto [entry, first] = route.last_seq.try_emplace(head->source, head->seq);
  // A smaller number means that the source was restarted. A gap above kLargestGap cannot come from
  // a process of vismap.
  const int64_t lost = head->seq - entry->second - 1;
  if (!first && lost > 0 && lost <= kLargestGap) {
    counters_[route.channel.name].lost += lost;
    // A hub replaces a waiting status by the newer one of the same process, so nothing is missing.
    if (route.channel.name != std::string_view(kStatusChannel.name)) {
      LogWarningRateLimited(std::string("lost ") + route.channel.name,
                            std::string(route.channel.name) + ": " + FormatCount(lost, "message") +
                                " of " + head->source + (lost == 1 ? " was" : " were") +
                                " lost before sequence number " + std::to_string(head->seq));
    }
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

int Bus::connections() const {
  return 1 + (HasUrgentRoutes() ? 1 : 0) + (sending_ != nullptr && url_.provider == "tcpq" ? 1 : 0);
}

bool Bus::FitsOrWarns(const Channel& channel, size_t bytes) const {
  if (bytes <= channel.max_bytes) return true;
  LogWarningRateLimited(std::string("too large ") + channel.name,
                        std::string(channel.name) + ": a message of " + FormatBytes(bytes) +
                            " was not sent; at most " + FormatBytes(channel.max_bytes) +
                            " are allowed");
  return false;
}

bool Bus::Send(const Channel& channel, std::span<const uint8_t> bytes) {
  ChannelCounters& counters = counters_[channel.name];
  if (!FitsOrWarns(channel, bytes.size()) || !connected() ||
      !transport_->Publish(options_.channel_prefix + channel.name, bytes)) {
    ++counters.unsent;
    return false;
  }
  ++counters.published;
  counters.published_bytes += static_cast<int64_t>(bytes.size());
  return true;
}

void Bus::SendByThread() {
  if (sending_ != nullptr) return;
  sending_ = std::make_unique<SendingThread>(
      [this](const Channel& channel, const RawBytes& bytes) {
        return SendInThread(channel, bytes);
      },
      kMostWaitToBeSent);
}

// By STATUS a hub knows the name of the connection that receives, see HubClient::LearnName.
bool Bus::IsSentByThread(const Channel& channel) const {
  return sending_ != nullptr && std::string_view(channel.name) != kStatusChannel.name;
}

bool Bus::WaitForRoom(double seconds) const {
  return sending_ == nullptr || sending_->WaitForRoom(seconds);
}

bool Bus::WaitUntilSent(double seconds) const {
  return sending_ == nullptr || sending_->WaitUntilSent(seconds);
}

// While it waits it receives, so that hub and process cannot wait for each other forever.
bool Bus::SendLater(const Channel& channel, size_t bytes, SendingThread::Encode encode) {
  if (!connected()) {
    ++counters_[channel.name].unsent;
    return false;
  }
  while (!sending_->WaitForRoom(0.02)) {
    if (stop_requested()) {  // a map that is to be saved does not wait for slow readers
      ++counters_[channel.name].unsent;
      return false;
    }
    if (transport_ != nullptr) transport_->ReadAhead();
  }
  sending_->Add(channel, bytes, std::move(encode));
  return true;
}

bool Bus::SendInThread(const Channel& channel, std::span<const uint8_t> bytes) {
  if (!FitsOrWarns(channel, bytes.size())) return false;
  Transport* const transport = TransportOfThread();
  return transport != nullptr && transport->Publish(options_.channel_prefix + channel.name, bytes);
}

// The connection of the sending thread; nullptr = there is none now. All functions of LCM may be
// called by several threads.
Transport* Bus::TransportOfThread() {
  if (url_.provider != "tcpq") return transport_.get();
  // Reading shows whether a hub that was restarted has ended it.
  if (outgoing_ != nullptr) outgoing_->ReadAhead();
  if (outgoing_ != nullptr && outgoing_->connected()) return outgoing_.get();
  const double now = MonotonicSeconds();
  if (now < next_outgoing_attempt_) return nullptr;
  next_outgoing_attempt_ = now + kRejoinPeriod;
  auto opened = OpenTcpqTransport(url_.hub, options_.stop);
  if (!opened) {
    LogWarningRateLimited("sending connection",
                          "no message but STATUS is sent, since the second connection to the hub "
                          "cannot be opened: " +
                              opened.error().message);
  }
  outgoing_ = opened ? std::move(*opened) : nullptr;
  return outgoing_.get();
}

// Takes over what the sending thread has counted.
void Bus::CountSent() {
  if (sending_ == nullptr) return;
  for (const auto& [channel, totals] : sending_->TakeTotals()) {
    ChannelCounters& counters = counters_[channel];
    counters.published += totals.sent;
    counters.published_bytes += totals.sent_bytes;
    counters.unsent += totals.unsent;
  }
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

void Bus::RunWatched(std::span<const pollfd> files) {
  for (size_t i = 0; i < files.size(); ++i) {
    if (files[i].revents != 0) watched_[i].second();
  }
}

// Handles a message that has arrived. Returns false when there is none.
bool Bus::HandleOne(Transport* transport) {
  const Transport::Sink sink = [this](const std::string& on_bus, std::span<const uint8_t> bytes) {
    Dispatch(on_bus, bytes);
  };
  if (transport == nullptr || stop_requested() || !transport->Receive(sink)) return false;
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  return true;
}

bool Bus::HandleWaiting() {
  const double end = MonotonicSeconds() + kRound;
  bool any = false, more = true;
  // Messages that were read before the connection ended are handled, too.
  while (more && MonotonicSeconds() < end) {
    more = false;
    const double urgent_end = MonotonicSeconds() + kUrgentRound;
    while (MonotonicSeconds() < urgent_end && HandleOne(urgent_.get())) more = true;
    if (HandleOne(transport_.get())) more = true;
    any = any || more;
  }
  DeliverNewest();
  return any;
}

std::map<std::string, int64_t> Bus::CountUnhandled(double timeout) {
  constexpr int kSilenceMs = 20;  // after which nothing more is expected
  std::map<std::string, int64_t> unhandled;
  const Transport::Sink sink = [&](const std::string& on_bus, std::span<const uint8_t>) {
    const std::optional<std::string> channel = WithoutPrefix(on_bus, options_.channel_prefix);
    if (channel && counters_.contains(*channel)) ++unhandled[*channel];
  };
  const double end = MonotonicSeconds() + timeout;
  while (transport_ != nullptr && MonotonicSeconds() < end) {
    if (transport_->Receive(sink)) continue;
    pollfd waiting{connected() ? transport_->fd() : -1, POLLIN, 0};
    if (poll(&waiting, 1, kSilenceMs) != 1) break;
  }
  return unhandled;
}

void Bus::DeliverNewest() {
  for (size_t i = 0; i < routes_.size(); ++i) {
    if (!routes_[i]->has_newest) continue;
    routes_[i]->has_newest = false;
    const std::vector<uint8_t> bytes = std::exchange(routes_[i]->newest, {});
    Deliver(*routes_[i], bytes);
  }
}

double Bus::SecondsWithoutWork() const {
  if (transport_ == nullptr) return MonotonicSeconds() - last_work_;
  pollfd waiting{transport_->fd(), POLLIN, 0};
  if (transport_->pending() || poll(&waiting, 1, 0) > 0) return 0;
  return MonotonicSeconds() - last_work_;
}

bool Bus::Spin(double timeout) {
  CountSent();
  double wait = std::min(timeout, RunTimers());
  const auto has_pending = [](const auto& transport) {
    return transport != nullptr && transport->pending();
  };
  const bool pending = has_pending(transport_) || has_pending(urgent_);
  if (!connected() && !pending) {
    Rejoin();
    wait = std::min(wait, kRejoinPeriod);
  }
  if (connected()) JoinUrgent();
  const auto fd_of = [](const auto& transport) {
    return transport != nullptr && transport->connected() ? transport->fd() : -1;
  };
  std::vector<pollfd> waiting = {{options_.stop != nullptr ? options_.stop->fd() : -1, POLLIN, 0},
                                 {fd_of(transport_), POLLIN, 0},
                                 {fd_of(urgent_), POLLIN, 0}};
  for (const auto& entry : watched_) waiting.push_back({entry.first, POLLIN, 0});
  poll(waiting.data(), waiting.size(), pending ? 0 : static_cast<int>(std::ceil(wait * 1000)));
  RunWatched(std::span<const pollfd>(waiting).subspan(3));
  return (pending || waiting[1].revents != 0 || waiting[2].revents != 0) && HandleWaiting();
}

std::vector<int> Bus::FileDescriptors() const {
  std::vector<int> descriptors;
  for (const Transport* transport : {transport_.get(), urgent_.get()}) {
    if (transport != nullptr && transport->connected()) descriptors.push_back(transport->fd());
  }
  for (const auto& entry : watched_) descriptors.push_back(entry.first);
  return descriptors;
}

bool Bus::Run(const std::function<bool()>& finished) {
  while (!stop_requested()) {
    if (finished()) return true;
    Spin(0.1);
  }
  return false;
}

}  // namespace vismap
