#pragma once

#include <poll.h>

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
#include "runtime/sending_thread.h"
#include "runtime/stop_signal.h"
#include "runtime/transport.h"
#include "wire/channels.h"
#include "wire/envelope.h"

namespace vismap {

struct BusOptions {
  /// URL of the bus: tcpq://A.B.C.D:PORT, udpm://..., or memq:// (within one Bus, for tests).
  std::string url = DefaultLcmUrl();
  std::string source;           ///< name of this process; it is in every message that it publishes
  double connect_timeout = 10;  ///< how long Open waits for a hub [s]
  const StopSignal* stop = nullptr;  ///< ends waiting and Run; must outlive the bus
  /// Stands before the names of all channels on the bus, see CheckChannelPrefix.
  std::string channel_prefix = {};
};

/// Which messages a handler gets when several arrive while the process is busy.
enum class Delivery {
  kEvery,   ///< every message, in order; the hub queues the waiting ones
  kLatest,  ///< only the newest message, for viewers
  kUrgent,  ///< every message, also while many of other channels wait: on a hub, these channels
            ///< have a connection of their own, which is read between any two messages of the
            ///< others
};

/// Totals of one channel since the process started.
struct ChannelCounters {
  int64_t received = 0, received_bytes = 0;
  int64_t rejected = 0;    ///< malformed, or rejected by the handler
  int64_t lost = 0;        ///< missing sequence numbers, over all sources
  int64_t superseded = 0;  ///< replaced by a newer one before it was handled (Delivery::kLatest)
  int64_t published = 0, published_bytes = 0;
  int64_t unsent = 0;  ///< not published: no connection, or too large
};

/// A connection to the bus with typed messages, for use by one thread, unless a function says
/// otherwise. It connects again when the
/// hub was restarted, fills in sequence number, source and checksum of every message, and calls
/// handlers only with messages that decoded completely. Malformed, rejected and missing messages
/// are counted per channel, and reported in the log at a limited rate.
class Bus {
 public:
  /// Connects to the bus. Fails when the URL or the prefix is wrong, when no hub answers within
  /// connect_timeout, when there is no multicast route, or when stop was requested. The message
  /// names the command that solves the problem.
  static Result<std::unique_ptr<Bus>> Open(const BusOptions& options);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Makes Spin and Run call `handler(const Message&)` for messages of the channel. The handler
  /// returns void, or Result<void> if it may reject a message. An exception from it leaves Spin.
  /// Everything that the handler refers to must exist as long as Spin or Run is called.
  template <typename Message, typename Handler>
  void Subscribe(const Channel& channel, Handler handler, Delivery delivery = Delivery::kEvery);

  /// Fills in seq, source and (if the type has one) checksum, and sends the message. Returns false,
  /// and counts it as unsent, when there is no connection or the message is larger than the channel
  /// allows.
  template <typename Message>
  bool Publish(const Channel& channel, Message message);

  /// Sends a message without changing its seq and source, to forward messages of other processes
  /// and for tests.
  template <typename Message>
  bool PublishAsIs(const Channel& channel, Message message);

  /// From now on a thread of its own encodes and sends all messages but STATUS, in the order in
  /// which they are published, so that this thread does not wait until megabytes are sent. On a hub
  /// they have a connection of their own. Publish then returns true for a message that waits to be
  /// sent, and counters() shows with the next Spin what became of it. While 64 MB wait, Publish
  /// waits. The destructor sends what waits, as SendingThread does.
  void SendByThread();
  /// Waits until Publish need not wait, at most `seconds`; then returns true. For threads that make
  /// many messages which this one publishes. May be called by any thread.
  bool WaitForRoom(double seconds) const;
  /// Waits until all that was published is sent, at most `seconds`; then returns true.
  bool WaitUntilSent(double seconds) const;

  /// Makes Spin and Run call `action` every `period` [s], for the first time after one period.
  void Every(double period, std::function<void()> action);

  /// Makes Spin and Run wait for this file, too, and call `action` when there is something to read.
  /// `fd` must stay open as long as Spin or Run is called.
  void Watch(int fd, std::function<void()> action) { watched_.emplace_back(fd, std::move(action)); }

  /// Waits up to `timeout` [s] for a message, a timer, a watched file or stop, then handles the
  /// messages and timers that are due. Returns true when it handled a message.
  bool Spin(double timeout);

  /// One of them is readable when a message arrives, or when a watched file is readable. For loops
  /// of other libraries: call Spin(0), again while it returns true, and ask for the descriptors
  /// anew afterwards, since the bus may have connected again.
  std::vector<int> FileDescriptors() const;

  /// Calls Spin until `finished` returns true or stop is requested. `finished` is called at least
  /// every 0.1 s. Returns false when stop was requested.
  bool Run(const std::function<bool()>& finished = [] { return false; });

  /// Receives what is still on its way, for at most `timeout` [s], and handles none of it. Returns
  /// how many messages of each channel there were. For the end of a process.
  std::map<std::string, int64_t> CountUnhandled(double timeout);

  bool stop_requested() const { return options_.stop != nullptr && options_.stop->requested(); }
  bool connected() const;
  /// Number of connections to the hub: 1, one more with channels that are urgent, and one more with
  /// SendByThread.
  int connections() const;
  /// How long no message of a channel that is not urgent has been handled [s]; 0 while one waits.
  double SecondsWithoutWork() const;
  const std::string& source() const { return options_.source; }
  const std::string& url() const { return url_.text; }
  const std::string& channel_prefix() const { return options_.channel_prefix; }
  const std::map<std::string, ChannelCounters>& counters() const { return counters_; }
  int64_t reconnects() const { return reconnects_; }

 private:
  struct Route {
    Channel channel{};
    Delivery delivery = Delivery::kEvery;
    bool counts = false;  // the first subscription of a channel updates its counters
    std::function<Result<void>(std::span<const uint8_t>)> handle;
    int64_t fingerprint = 0;
    std::map<std::string, int64_t> last_seq;  // per source
    std::vector<uint8_t> newest;              // message of kLatest that is not handled yet
    bool has_newest = false;
  };
  struct Timer {
    double period = 0, due = 0;
    std::function<void()> action;
  };

  explicit Bus(const BusOptions& options, LcmUrl url);
  Result<void> Join();
  void JoinUrgent();
  bool IsUrgent(const Route& route) const;
  bool HasUrgentRoutes() const;
  Result<void> JoinWithin(double timeout);
  void Rejoin();
  void AddRoute(std::unique_ptr<Route> route);
  void Subscribe(Transport* transport, const Channel& channel) const;
  void Dispatch(const std::string& on_bus, std::span<const uint8_t> bytes);
  void Receive(Route& route, std::span<const uint8_t> bytes);
  void Deliver(Route& route, std::span<const uint8_t> bytes);
  void TrackSequence(Route& route, std::span<const uint8_t> bytes);
  bool FitsOrWarns(const Channel& channel, size_t bytes) const;
  bool Send(const Channel& channel, std::span<const uint8_t> bytes);
  bool IsSentByThread(const Channel& channel) const;
  bool SendLater(const Channel& channel, size_t bytes, SendingThread::Encode encode);
  bool SendInThread(const Channel& channel, std::span<const uint8_t> bytes);
  Transport* TransportOfThread();
  void CountSent();
  bool HandleOne(Transport* transport);
  bool HandleWaiting();
  void DeliverNewest();
  double RunTimers();
  void RunWatched(std::span<const pollfd> files);

  BusOptions options_;
  LcmUrl url_;
  std::unique_ptr<Transport> transport_;  // nullptr or not connected while there is no hub
  std::unique_ptr<Transport> urgent_;     // for urgent channels; nullptr when there are none
  std::vector<std::unique_ptr<Route>> routes_;
  std::vector<Timer> timers_;
  std::vector<std::pair<int, std::function<void()>>> watched_;  // files
  std::map<std::string, int64_t> next_seq_;
  std::map<std::string, ChannelCounters> counters_;
  std::exception_ptr thrown_;  // exception of a handler; it must not pass through LCM's C code
  int64_t reconnects_ = 0;
  double next_attempt_ = 0, next_urgent_attempt_ = 0;  // to connect again, MonotonicSeconds
  double last_work_ = 0;  // when a message that is not urgent was handled, MonotonicSeconds

  // For the sending thread alone: its connection to a hub, and when it may connect again.
  std::unique_ptr<Transport> outgoing_;
  double next_outgoing_attempt_ = 0;
  std::unique_ptr<SendingThread> sending_;  // ends before what it uses; nullptr = there is none
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
  return PublishAsIs(channel, std::move(message));
}

template <typename Message>
bool Bus::PublishAsIs(const Channel& channel, Message message) {
  if (!IsSentByThread(channel)) return Send(channel, PackRaw(message));
  const auto bytes = static_cast<size_t>(message.getEncodedSize());
  return SendLater(channel, bytes,
                   [message = std::move(message)]() mutable { return PackRaw(message); });
}

}  // namespace vismap
