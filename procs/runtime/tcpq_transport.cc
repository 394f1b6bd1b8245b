#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <deque>
#include <utility>

#include "runtime/clock.h"
#include "runtime/tcp_socket.h"
#include "runtime/tcpq_records.h"
#include "runtime/transport.h"
#include "wire/channels.h"

namespace vismap {
namespace {

constexpr double kConnectTimeout = 1.0;  // [s]
// Without any progress; longer than the patience of a hub [s].
constexpr double kSendTimeout = 90.0;
constexpr size_t kReadPerTurn = 256 * 1024;  // [bytes]
// Largest amount read ahead while sending [bytes].
constexpr size_t kMaxInboxBytes = 256 * kMegabyte;
// Memory of a message besides its bytes, so that a flood of empty ones is bounded, too [bytes].
constexpr size_t kEntryBytes = 256;

class TcpqTransport : public Transport {
 public:
  TcpqTransport(Socket socket, const StopSignal* stop)
      : socket_(std::move(socket)), reader_(TcpqMagic::kHub, kMaxMessageBytes), stop_(stop) {
    reader_.SkipHello();
  }

  bool connected() const override { return socket_.open(); }
  int fd() const override { return socket_.fd(); }
  bool pending() const override { return !inbox_.empty(); }

  void Subscribe(const std::string& channel) override { Send(TcpqSubscribe(channel), {}); }

  bool Publish(const std::string& channel, std::span<const uint8_t> data) override {
    return Send(TcpqPublishHead(channel, data.size()), data);
  }

  bool Receive(const Sink& sink) override {
    if (inbox_.empty()) Read();
    if (inbox_.empty()) return false;
    const TcpqRecord record = std::move(inbox_.front());
    inbox_.pop_front();
    inbox_bytes_ -= record.bytes->size() + kEntryBytes;
    sink(record.name, record.data());
    return true;
  }

  void ReadAhead() override {
    if (inbox_bytes_ < kMaxInboxBytes) Read();
  }

 private:
  void Read() {
    if (!socket_.open()) return;
    const Result<void> read =
        reader_.ReadFrom(socket_.fd(), kReadPerTurn, [this](TcpqRecord record) {
          if (record.kind != TcpqRecord::Kind::kPublish) return;
          inbox_bytes_ += record.bytes->size() + kEntryBytes;
          inbox_.push_back(std::move(record));
        });
    if (!read) socket_.Close();
  }

  // Sends a whole record, or closes the connection: after a partial record the hub could not find
  // the next one.
  bool Send(std::span<const uint8_t> head, std::span<const uint8_t> data) {
    double last_progress = MonotonicSeconds();
    while (socket_.open() && head.size() + data.size() > 0) {
      const ssize_t sent = SendSome(head, data);
      if (sent > 0) {
        const size_t of_head = std::min(head.size(), static_cast<size_t>(sent));
        head = head.subspan(of_head);
        data = data.subspan(static_cast<size_t>(sent) - of_head);
        last_progress = MonotonicSeconds();
      } else if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) {
        socket_.Close();
      } else if (!WaitToSend(last_progress)) {
        socket_.Close();
      }
    }
    return socket_.open();
  }

  ssize_t SendSome(std::span<const uint8_t> head, std::span<const uint8_t> data) const {
    iovec parts[2] = {{const_cast<uint8_t*>(head.data()), head.size()},
                      {const_cast<uint8_t*>(data.data()), data.size()}};
    msghdr message{};
    message.msg_iov = parts;
    message.msg_iovlen = 2;
    return sendmsg(socket_.fd(), &message, MSG_NOSIGNAL | MSG_DONTWAIT);
  }

  // Waits until the socket accepts data, and receives meanwhile. Returns false when there was no
  // progress for too long.
  bool WaitToSend(double last_progress) {
    const bool room = inbox_bytes_ < kMaxInboxBytes;
    pollfd waiting{socket_.fd(), static_cast<short>(POLLOUT | (room ? POLLIN : 0)), 0};
    poll(&waiting, 1, 100);
    if ((waiting.revents & POLLIN) != 0) Read();
    const double patience = stop_ != nullptr && stop_->requested() ? 1.0 : kSendTimeout;
    return MonotonicSeconds() - last_progress < patience;
  }

  Socket socket_;
  RecordReader reader_;
  const StopSignal* stop_;
  std::deque<TcpqRecord> inbox_;
  size_t inbox_bytes_ = 0;
};

}  // namespace

Result<std::unique_ptr<Transport>> OpenTcpqTransport(const TcpAddress& hub,
                                                     const StopSignal* stop) {
  Result<Socket> socket = ConnectToHub(hub, kConnectTimeout);
  if (!socket) return tl::unexpected(socket.error());
  return std::make_unique<TcpqTransport>(std::move(*socket), stop);
}

}  // namespace vismap
