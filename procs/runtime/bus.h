#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/result.h"
#include "runtime/lcm_url.h"
#include "runtime/stop_signal.h"
#include "runtime/transport.h"
#include "wire/channels.h"
#include "wire/envelope.h"

namespace vismap {

struct BusOptions {
  std::string url =
      DefaultLcmUrl();  ///< tcpq://A.B.C.D:PORT, udpm://..., or memq:// (inside one Bus, for tests)
  std::string source;   ///< name of this process on the bus, in every message it publishes
  double connect_timeout = 10;       ///< how long Open waits for a hub [s]
  const StopSignal* stop = nullptr;  ///< ends waiting and Run; must outlive the bus
};

/// What happens to messages that arrive while the process is busy.
enum class Delivery {
  kEvery,   ///< all are handled, in order; the hub keeps what waits
  kLatest,  ///< only the newest is handled when the process gets to it, for viewers
};

/// Totals of one channel since the process started.
struct ChannelCounters {
  int64_t received = 0, received_bytes = 0;
  int64_t rejected = 0;    ///< malformed, or refused by the handler
  int64_t lost = 0;        ///< numbers missing in the sequences of the sources
  int64_t superseded = 0;  ///< not looked at because a newer one was there (Delivery::kLatest)
  int64_t published = 0, published_bytes = 0;
  int64_t unsent = 0;  ///< could not be published: no connection, or too large
};

/// Typed messages over LCM, for one thread. Joins the bus, keeps joined when a hub goes and comes
/// back, gives every message its sequence number, source and checksum, and hands handlers only
/// messages that decoded completely. What is malformed, refused or missing is counted per channel,
/// and said in the log now and then.
class Bus {
 public:
  /// Joins the bus. Fails with the command that mends it when the URL is wrong, no hub answers
  /// within connect_timeout, there is no multicast route, or stop was requested.
  static Result<std::unique_ptr<Bus>> Open(const BusOptions& options);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Calls `handler(const Message&)` from Spin or Run for every message of the channel. The handler
  /// returns void, or Result<void> to refuse a message (counted, and said in the log). What it
  /// throws comes out of Spin. Whatever it refers to must live for as long as the bus is spun.
  template <typename Message, typename Handler>
  void Subscribe(const Channel& channel, Handler handler, Delivery delivery = Delivery::kEvery);

  /// Sends a message after filling in seq, source and, where it has one, checksum. False, and
  /// counted, when it could not be sent: no connection to the hub just now, or larger than the
  /// channel allows.
  template <typename Message>
  bool Publish(const Channel& channel, Message message);

  /// Sends a message with the seq and source that it has: for passing on messages of others, and
  /// for tests.
  template <typename Message>
  bool PublishAsIs(const Channel& channel, Message message) {
    return Send(channel, Pack(message));
  }

  /// Calls `action` from Spin or Run every `period` [s], first after one period.
  void Every(double period, std::function<void()> action);

  /// Waits up to `timeout` [s] for messages, timers or stop; handles what is there. True when it
  /// handled a message.
  bool Spin(double timeout);

  /// Spins until `finished` returns true (asked after each round, at least every 0.1 s) or stop is
  /// requested. Returns false when stopped.
  bool Run(const std::function<bool()>& finished = [] { return false; });

  bool stop_requested() const { return options_.stop != nullptr && options_.stop->requested(); }
  bool connected() const;
  const std::string& source() const { return options_.source; }
  const std::string& url() const { return url_.text; }
  const std::map<std::string, ChannelCounters>& counters() const { return counters_; }
  int64_t reconnects() const { return reconnects_; }

 private:
  struct Route {
    Channel channel{};
    Delivery delivery = Delivery::kEvery;
    bool counts = false;  // the first subscription of a channel keeps its figures
    std::function<Result<void>(std::span<const uint8_t>)> handle;
    int64_t fingerprint = 0;
    std::map<std::string, int64_t> last_seq;  // per source
    std::vector<uint8_t> newest;              // of kLatest, until it is handled
    bool has_newest = false;
  };
  struct Timer {
    double period = 0, due = 0;
    std::function<void()> action;
  };

  explicit Bus(const BusOptions& options, LcmUrl url);
  Result<void> Join();
  Result<void> JoinWithin(double timeout);
  void Rejoin();
  void AddRoute(std::unique_ptr<Route> route);
  void Dispatch(const std::string& channel, std::span<const uint8_t> bytes);
  void Receive(Route& route, std::span<const uint8_t> bytes);
  void Deliver(Route& route, std::span<const uint8_t> bytes);
  void TrackSequence(Route& route, std::span<const uint8_t> bytes);
  bool Send(const Channel& channel, const std::vector<uint8_t>& bytes);
  bool HandleWaiting();
  void DeliverNewest();
  double RunTimers();

  BusOptions options_;
  LcmUrl url_;
  std::unique_ptr<Transport> transport_;  // none or not connected while there is no hub
  std::vector<std::unique_ptr<Route>> routes_;
  std::vector<Timer> timers_;
  std::map<std::string, int64_t> next_seq_;
  std::map<std::string, ChannelCounters> counters_;
  std::exception_ptr thrown_;  // by a handler; must not pass through LCM's C code
  int64_t reconnects_ = 0;
  double next_attempt_ = 0;
};

template <typename Message, typename Handler>
void Bus::Subscribe(const Channel& channel, Handler handler, Delivery delivery) {
  auto route = std::make_unique<Route>();
  route->channel = channel;
  route->delivery = delivery;
  route->fingerprint = Message::getHash();
  route->handle = [channel, handler = std::move(handler)](
                      std::span<const uint8_t> bytes) mutable -> Result<void> {
    const Result<Message> message = Unpack<Message>(bytes, channel.max_bytes);
    if (!message) return tl::unexpected(message.error());
    if constexpr (std::is_void_v<decltype(handler(*message))>) {
      handler(*message);
      return {};
    } else {
      return handler(*message);
    }
  };
  AddRoute(std::move(route));
}

template <typename Message>
bool Bus::Publish(const Channel& channel, Message message) {
  message.seq = next_seq_[channel.name]++;
  message.source = options_.source;
  return Send(channel, Pack(message));
}

}  // namespace vismap
