#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "queueing/message_queue.h"
#include "runtime/tcp_socket.h"
#include "runtime/tcpq_records.h"

namespace vismap {

/// One end of a tcpq connection that never blocks. Messages that the other end cannot accept yet
/// wait in a queue, also while there is no connection.
class QueuedConnection {
 public:
  /// Starts without a connection. `max_message_bytes` is the limit for received messages.
  QueuedConnection(size_t max_message_bytes, const QueueLimits& limits);

  /// Takes over a connected socket. `reader` continues after the part of the greeting that has been
  /// read. `opening` is sent first, then the message that the previous connection had not sent
  /// completely.
  void Open(Socket socket, RecordReader reader, std::vector<uint8_t> opening);
  bool open() const { return socket_.open(); }
  int fd() const { return socket_.fd(); }
  void Close() { socket_.Close(); }

  /// Reads what has arrived, about `max_bytes` at most, and for 2 ms at most. Closes the connection
  /// and fails when the other end has closed it (message "") or violates the protocol.
  Result<void> Read(size_t max_bytes, const std::function<void(TcpqRecord)>& on_record);

  /// See MessageQueue::Add.
  MessageQueue::Added Add(const RoutedMessage& message, bool sender_waits);
  /// Sends as much as possible without blocking. Closes the connection when it has ended.
  void Flush();

  const MessageQueue& queue() const { return queue_; }
  /// Whether data waits to be sent, so that the caller must poll for POLLOUT.
  bool wants_to_send() const { return !opening_.empty() || sending_ != nullptr || !queue_.empty(); }
  /// How long data has been waiting without the other end accepting a single byte [s]; 0 when no
  /// data waits.
  double SecondsStuck() const;
  /// Age of the oldest data that waits to be sent [s]; 0 when no data waits. It also grows for a
  /// reader that accepts only a few bytes from time to time.
  double SecondsBehind() const;
  /// How long the greeting or a record has been incomplete, minus the time that its missing bytes
  /// need at `bytes_per_second`, so that a large record has more time [s]; 0 when none is
  /// incomplete.
  double SecondsIncomplete(double bytes_per_second) const;
  bool has_greeting() const { return reader_.has_greeting(); }
  /// Memory of the connection: the queue, the message being sent, and the arrived part of an
  /// incomplete record [bytes].
  size_t buffered_bytes() const {
    const size_t sending = sending_ != nullptr ? sending_->size() : 0;
    return queue_.bytes() + sending + reader_.buffered_bytes();
  }

 private:
  bool SendSome(std::span<const uint8_t> bytes);

  Socket socket_;
  RecordReader reader_;
  std::vector<uint8_t> opening_;
  RecordBytes sending_;  // message being sent, already removed from the queue
  MessageQueue queue_;
  size_t sent_ = 0;  // bytes sent of opening_ or, if that is empty, of sending_
  double last_progress_ = 0;
  double sending_since_ = 0;   // when the message being sent was queued
  double complete_since_ = 0;  // when the last record was complete
};

}  // namespace vismap
