#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "queueing/message_queue.h"
#include "runtime/tcp_socket.h"
#include "runtime/tcpq_records.h"

namespace vismap {

/// One end of a tcpq connection that never waits: what the other end cannot take yet stays in a
/// queue, also while there is no connection.
class QueuedConnection {
 public:
  /// Not connected. `max_message_bytes` of what is received; `queue_bytes`: see MessageQueue.
  QueuedConnection(size_t max_message_bytes, size_t queue_bytes);

  /// Takes a connected socket over. `reader` = as far as its greeting has been read; `opening` is
  /// sent before anything else, then a message that an earlier connection had begun.
  void Open(Socket socket, RecordReader reader, std::vector<uint8_t> opening);
  bool open() const { return socket_.open(); }
  int fd() const { return socket_.fd(); }
  void Close() { socket_.Close(); }

  /// Takes what has arrived, up to about `max_bytes`. Fails, and closes, when the connection has
  /// ended ("" = in good order) or the bytes are not the protocol.
  Result<void> Read(size_t max_bytes, const std::function<void(TcpqRecord)>& on_record);

  /// See MessageQueue::Add.
  MessageQueue::Added Add(const RoutedMessage& message, bool sender_waits);
  /// Sends as much as goes without waiting. Closes when the connection has ended.
  void Flush();

  const MessageQueue& queue() const { return queue_; }
  /// Something waits to be sent: poll for POLLOUT.
  bool wants_to_send() const { return !opening_.empty() || sending_ != nullptr || !queue_.empty(); }
  /// Since when something has been waiting without a single byte being taken [s]; 0 when nothing
  /// waits.
  double SecondsStuck() const;

 private:
  bool SendSome(const std::vector<uint8_t>& bytes);

  Socket socket_;
  RecordReader reader_;
  std::vector<uint8_t> opening_;
  SharedBytes sending_;  // taken from the queue
  MessageQueue queue_;
  size_t sent_ = 0;  // of opening_, or else of sending_
  double last_progress_ = 0;
};

}  // namespace vismap
