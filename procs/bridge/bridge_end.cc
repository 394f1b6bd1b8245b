#include "bridge/bridge_end.h"

#include <utility>

#include "base/format.h"
#include "queueing/queued_connection.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/transport.h"
#include "wire/channels.h"

namespace vismap {
namespace {

constexpr double kRetryPeriod = 0.5;              // [s]
constexpr double kConnectTimeout = 1.0;           // [s]
constexpr size_t kReadPerTurn = size_t{2} << 20;  // [bytes]
// A hub that accepts no data for so long counts as lost [s]. It is longer than the patience of a
// hub with a slow client.
constexpr double kPatience = 90;
constexpr int kMessagesPerTurn = 16;

class HubEnd : public BridgeEnd {
 public:
  HubEnd(const LcmUrl& url, const BridgeEndOptions& options)
      : url_(url),
        options_(options),
        connection_(kMaxMessageBytes, QueueLimits{options.queue_bytes}) {}

  const std::string& url() const override { return url_.text; }
  bool connected() const override { return connection_.open(); }
  const std::string& trouble() const override { return trouble_; }
  int64_t reconnects() const override { return reconnects_; }
  int fd() const override { return connection_.fd(); }
  bool wants_to_send() const override { return connection_.wants_to_send(); }
  bool full() const override { return connection_.queue().full(); }
  size_t queued_bytes() const override { return connection_.queue().bytes(); }

  void KeepConnected() override {
    if (connected() && connection_.SecondsStuck() > kPatience) {
      connection_.Close();
      trouble_ = "the hub accepted no data for " + FormatDuration(kPatience);
    }
    if (connected() || MonotonicSeconds() < next_attempt_) return;
    if (was_connected_) {
      LogWarning("the connection to " + url_.text + " was lost" +
                 (trouble_.empty() ? "" : ": " + trouble_) + "; trying to connect again");
    }
    was_connected_ = false;
    Connect();
    next_attempt_ = MonotonicSeconds() + kRetryPeriod;
  }

  void Receive(const std::function<void(const TcpqRecord&)>& sink) override {
    const Result<void> read = connection_.Read(kReadPerTurn, [&](TcpqRecord record) {
      if (record.kind == TcpqRecord::Kind::kPublish) sink(record);
    });
    if (!read) trouble_ = read.error().message;
  }

  MessageQueue::Added Add(const RoutedMessage& message) override {
    return connection_.Add(message, connected());
  }

  void Flush() override {
    if (connected()) connection_.Flush();
  }

 private:
  void Connect() {
    Result<Socket> socket = ConnectToHub(url_.hub, kConnectTimeout);
    if (!socket) {
      trouble_ = socket.error().message;
      return;
    }
    std::vector<uint8_t> subscriptions;
    for (const std::string& channel : options_.channels) {
      const std::vector<uint8_t> record = TcpqSubscribe(ExpressionFor(channel));
      subscriptions.insert(subscriptions.end(), record.begin(), record.end());
    }
    RecordReader reader(TcpqMagic::kHub, kMaxMessageBytes);
    reader.SkipHello();
    connection_.Open(std::move(*socket), std::move(reader), std::move(subscriptions));
    trouble_.clear();
    if (ever_connected_) ++reconnects_;
    was_connected_ = ever_connected_ = true;
    LogInfo("connected to " + url_.text);
  }

  LcmUrl url_;
  BridgeEndOptions options_;
  QueuedConnection connection_;
  std::string trouble_ = "not connected yet";
  double next_attempt_ = 0;
  int64_t reconnects_ = 0;
  bool was_connected_ = false, ever_connected_ = false;
};

/// A bus without a hub: LCM sends every message immediately, so there is no queue.
class LcmEnd : public BridgeEnd {
 public:
  LcmEnd(const LcmUrl& url, std::unique_ptr<Transport> transport)
      : url_(url), transport_(std::move(transport)) {}

  const std::string& url() const override { return url_.text; }
  void KeepConnected() override {}
  bool connected() const override { return true; }
  const std::string& trouble() const override { return trouble_; }
  int64_t reconnects() const override { return 0; }
  int fd() const override { return transport_->fd(); }
  bool wants_to_send() const override { return false; }
  bool full() const override { return false; }
  size_t queued_bytes() const override { return 0; }
  void Flush() override {}

  void Receive(const std::function<void(const TcpqRecord&)>& sink) override {
    const Transport::Sink receive = [&](const std::string& channel, std::span<const uint8_t> data) {
      sink(TcpqPublish(channel, data));
    };
    for (int i = 0; i < kMessagesPerTurn && transport_->Receive(receive); ++i) {
    }
  }

  MessageQueue::Added Add(const RoutedMessage& message) override {
    const TcpqRecord record{TcpqRecord::Kind::kPublish, message.channel, message.record};
    return transport_->Publish(message.channel, record.data()) ? MessageQueue::Added::kQueued
                                                               : MessageQueue::Added::kDropped;
  }

 private:
  LcmUrl url_;
  std::unique_ptr<Transport> transport_;
  std::string trouble_;
};

}  // namespace

Result<std::unique_ptr<BridgeEnd>> OpenBridgeEnd(const LcmUrl& url,
                                                 const BridgeEndOptions& options) {
  if (url.provider == "tcpq") return std::make_unique<HubEnd>(url, options);
  Result<std::unique_ptr<Transport>> transport = OpenLcmTransport(url);
  if (!transport) return tl::unexpected(transport.error());
  for (const std::string& channel : options.channels)
    (*transport)->Subscribe(ExpressionFor(channel));
  return std::make_unique<LcmEnd>(url, std::move(*transport));
}

}  // namespace vismap
