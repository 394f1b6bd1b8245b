#include "runtime/bus.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>

#include <algorithm>
#include <cmath>
#include <lcm/lcm-cpp.hpp>
#include <utility>

#include "runtime/clock.h"
#include "runtime/log.h"

namespace vismap {
namespace {

constexpr double kRejoinPeriod = 0.25;  // [s]
constexpr int kMessagesPerRound = 64;   // before timers get their turn
constexpr size_t kMaxTrackedSources = 1024;
constexpr int64_t kLargestGap = 1'000'000'000;

template <typename Value>
void SetOption(int fd, int level, int option, Value value) {
  setsockopt(fd, level, option, &value, sizeof(value));
}

// LCM sends each message in five small pieces and waits without limit: send at once, notice a hub
// that is gone or stands still.
void TuneTcp(int fd) {
  SetOption(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  SetOption(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  SetOption(fd, IPPROTO_TCP, TCP_KEEPIDLE, 10);
  SetOption(fd, IPPROTO_TCP, TCP_KEEPINTVL, 5);
  SetOption(fd, IPPROTO_TCP, TCP_KEEPCNT, 3);
  SetOption(fd, SOL_SOCKET, SO_SNDTIMEO, timeval{30, 0});
  SetOption(fd, SOL_SOCKET, SO_RCVTIMEO, timeval{30, 0});
}

bool Readable(int fd) {
  pollfd waiting{fd, POLLIN, 0};
  return poll(&waiting, 1, 0) == 1;
}

}  // namespace

Bus::Bus(const BusOptions& options, LcmUrl url) : options_(options), url_(std::move(url)) {}
Bus::~Bus() = default;

Result<std::unique_ptr<Bus>> Bus::Open(const BusOptions& options) {
  signal(SIGPIPE, SIG_IGN);
  const Result<LcmUrl> url = ParseLcmUrl(options.url);
  if (!url) return tl::unexpected(url.error());
  std::unique_ptr<Bus> bus(new Bus(options, *url));
  if (url->provider == "udpm") {
    const Result<void> buffer = ProbeReceiveBuffer(url->receive_buffer);
    if (!buffer) LogWarning(buffer.error().message);
  }
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
      return Fail("no hub at " + url_.text + " (" + joined.error().message +
                  "); start one with: vismap-hub --listen " + url_.hub.host + ":" +
                  std::to_string(url_.hub.port));
    }
    if (!told) LogInfo("waiting for a hub at " + url_.text);
    told = true;
    const StopSignal never;
    if ((options_.stop != nullptr ? *options_.stop : never).WaitFor(0.1))
      return Fail("stopped while waiting for a hub");
  }
}

Result<void> Bus::Join() {
  lcm_.reset();
  if (url_.provider == "tcpq") {
    // LCM itself would wait for ever for a hub that accepts and says nothing.
    if (Result<void> probe = ProbeHub(url_.hub, 1.0); !probe) return probe;
  }
  auto joined = std::make_unique<lcm::LCM>(url_.text);
  if (!joined->good()) {
    return Fail("LCM cannot open " + url_.text +
                (url_.provider == "udpm"
                     ? "; without a multicast route run: sudo ip route add 224.0.0.0/4 dev lo"
                     : "; is the URL right?"));
  }
  lcm_ = std::move(joined);
  for (const std::unique_ptr<Route>& route : routes_) Listen(route.get());
  if (!connected()) return Fail("the hub closed the connection");
  if (url_.provider == "tcpq") TuneTcp(lcm_->getFileno());
  return {};
}

bool Bus::connected() const { return lcm_ != nullptr && lcm_->getFileno() >= 0; }

void Bus::Rejoin() {
  const double now = MonotonicSeconds();
  if (now < next_attempt_) return;
  if (lcm_ != nullptr) LogWarning("lost the hub at " + url_.text + ", trying to reach it again");
  next_attempt_ = now + kRejoinPeriod;
  if (Join()) {
    ++reconnects_;
    LogInfo("reached the hub at " + url_.text + " again");
  }
}

void Bus::AddRoute(std::unique_ptr<Route> route) {
  route->bus = this;
  const std::string name = route->channel.name;
  route->counts = std::none_of(routes_.begin(), routes_.end(),
                               [&](const auto& r) { return r->channel.name == name; });
  counters_[name];
  routes_.push_back(std::move(route));
  if (connected()) Listen(routes_.back().get());
}

void Bus::Listen(Route* route) {
  lcm::Subscription* subscription =
      lcm_->subscribeFunction(route->channel.name, &Bus::OnMessage, route);
  // Nothing may be dropped between socket and handler; what waits, waits in the hub or the kernel.
  if (subscription != nullptr) subscription->setQueueCapacity(0);
}

void Bus::OnMessage(const lcm::ReceiveBuffer* buffer, const std::string&, Route* route) {
  try {
    route->bus->Receive(*route, {static_cast<const uint8_t*>(buffer->data), buffer->data_size});
  } catch (...) {
    route->bus->thrown_ = std::current_exception();
  }
}

void Bus::Receive(Route& route, std::span<const uint8_t> bytes) {
  if (thrown_) return;
  if (route.counts) {
    ChannelCounters& counters = counters_[route.channel.name];
    ++counters.received;
    counters.received_bytes += static_cast<int64_t>(bytes.size());
    NoteSequence(route, bytes);
  }
  if (route.delivery == Delivery::kEvery || bytes.size() > route.channel.max_bytes)
    return Deliver(route, bytes);
  if (route.has_newest && route.counts) ++counters_[route.channel.name].superseded;
  route.newest.assign(bytes.begin(), bytes.end());
  route.has_newest = true;
}

void Bus::NoteSequence(Route& route, std::span<const uint8_t> bytes) {
  const std::optional<MessageHead> head = PeekHead(bytes);
  if (!head || head->fingerprint != route.fingerprint || head->seq < 0) return;
  if (route.last_seq.size() >= kMaxTrackedSources && !route.last_seq.contains(head->source)) return;
  const auto [entry, first] = route.last_seq.try_emplace(head->source, head->seq);
  // A smaller number means that the source was restarted; a leap beyond kLargestGap that it is not
  // our process.
  const int64_t lost = head->seq - entry->second - 1;
  if (!first && lost > 0 && lost <= kLargestGap) {
    counters_[route.channel.name].lost += lost;
    LogWarningSometimes(std::string("lost ") + route.channel.name,
                        std::string(route.channel.name) + ": " + std::to_string(lost) +
                            " messages of " + head->source + " are missing before number " +
                            std::to_string(head->seq));
  }
  entry->second = head->seq;
}

void Bus::Deliver(Route& route, std::span<const uint8_t> bytes) {
  const Result<void> handled = route.handle(bytes);
  if (handled) return;
  ++counters_[route.channel.name].rejected;
  LogWarningSometimes(std::string("rejected ") + route.channel.name,
                      std::string(route.channel.name) + ": rejected: " + handled.error().message);
}

bool Bus::Send(const Channel& channel, const std::vector<uint8_t>& bytes) {
  ChannelCounters& counters = counters_[channel.name];
  const bool fits = bytes.size() <= channel.max_bytes;
  if (!fits) {
    LogWarningSometimes(std::string("too large ") + channel.name,
                        std::string(channel.name) + ": a message of " +
                            std::to_string(bytes.size()) + " bytes was not sent, at most " +
                            std::to_string(channel.max_bytes) + " are allowed");
  }
  if (!fits || !connected() ||
      lcm_->publish(channel.name, bytes.data(), static_cast<unsigned>(bytes.size())) != 0) {
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

// Runs what is due; returns the seconds until the next one.
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
  bool any = false;
  for (int i = 0;
       i < kMessagesPerRound && connected() && Readable(lcm_->getFileno()) && !stop_requested();
       ++i) {
    any |= lcm_->handle() == 0;
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
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
  if (!connected()) {
    Rejoin();
    wait = std::min(wait, kRejoinPeriod);
  }
  pollfd waiting[2] = {{options_.stop != nullptr ? options_.stop->fd() : -1, POLLIN, 0},
                       {connected() ? lcm_->getFileno() : -1, POLLIN, 0}};
  poll(waiting, 2, static_cast<int>(std::ceil(wait * 1000)));
  return waiting[1].revents != 0 && HandleWaiting();
}

bool Bus::Run(const std::function<bool()>& finished) {
  while (!stop_requested()) {
    if (finished()) return true;
    Spin(0.1);
  }
  return false;
}

}  // namespace vismap
