#include "queueing/queued_connection.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "runtime/clock.h"

namespace vismap {

namespace {
// Records are handled for so long at a time [s]: a pattern of channels takes much more time to
// compile than its bytes take to arrive, and other connections must not wait for it.
constexpr double kLongestRead = 0.002;
}  // namespace

QueuedConnection::QueuedConnection(size_t max_message_bytes, const QueueLimits& limits)
    : reader_(TcpqMagic::kHub, max_message_bytes), queue_(limits) {}

void QueuedConnection::Open(Socket socket, RecordReader reader, std::vector<uint8_t> opening) {
  socket_ = std::move(socket);
  reader_ = std::move(reader);
  opening_ = std::move(opening);
  sent_ = 0;
  last_progress_ = sending_since_ = complete_since_ = MonotonicSeconds();
}

Result<void> QueuedConnection::Read(size_t max_bytes,
                                    const std::function<void(TcpqRecord)>& on_record) {
  const auto handle = [&](TcpqRecord record) {
    complete_since_ = MonotonicSeconds();
    on_record(std::move(record));
  };
  Result<void> read = reader_.ReadFrom(socket_.fd(), max_bytes, handle, kLongestRead);
  if (!reader_.has_part()) complete_since_ = MonotonicSeconds();
  if (!read) Close();
  return read;
}

MessageQueue::Added QueuedConnection::Add(const RoutedMessage& message, bool sender_waits) {
  if (!wants_to_send()) last_progress_ = MonotonicSeconds();
  return queue_.Add(message, sender_waits);
}

void QueuedConnection::Flush() {
  if (!opening_.empty()) {
    if (!SendSome(opening_)) return;
    opening_.clear();
  }
  while (socket_.open() && (sending_ != nullptr || !queue_.empty())) {
    if (sending_ == nullptr) {
      MessageQueue::Entry entry = queue_.Pop();
      sending_ = std::move(entry.message.record);
      sending_since_ = entry.since;
    }
    if (!SendSome(*sending_)) return;
    sending_.reset();
  }
}

// Returns true when all of `bytes` has been sent.
bool QueuedConnection::SendSome(std::span<const uint8_t> bytes) {
  while (socket_.open() && sent_ < bytes.size()) {
    const ssize_t sent =
        send(socket_.fd(), bytes.data() + sent_, bytes.size() - sent_, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0) {
      if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) Close();
      return false;
    }
    sent_ += static_cast<size_t>(sent);
    last_progress_ = MonotonicSeconds();
  }
  if (!socket_.open()) return false;
  sent_ = 0;
  return true;
}

double QueuedConnection::SecondsBehind() const {
  if (!opening_.empty()) return MonotonicSeconds() - last_progress_;
  const double sending = sending_ != nullptr ? MonotonicSeconds() - sending_since_ : 0;
  return std::max(sending, queue_.OldestSeconds());
}

double QueuedConnection::SecondsIncomplete(double bytes_per_second) const {
  if (!reader_.has_part()) return 0;
  const double granted = static_cast<double>(reader_.missing_bytes()) / bytes_per_second;
  return std::max(0.0, MonotonicSeconds() - complete_since_ - granted);
}

double QueuedConnection::SecondsStuck() const {
  return wants_to_send() ? MonotonicSeconds() - last_progress_ : 0;
}

}  // namespace vismap
