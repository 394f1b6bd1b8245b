#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "queueing/message_queue.h"
#include "runtime/lcm_url.h"
#include "runtime/tcpq_records.h"

namespace vismap {

/// One of the two buses that a bridge connects. Only KeepConnected may block, for a second when the
/// hub does not answer.
class BridgeEnd {
 public:
  virtual ~BridgeEnd() = default;

  virtual const std::string& url() const = 0;
  /// Connects again when the connection is lost and the next attempt is due.
  virtual void KeepConnected() = 0;
  virtual bool connected() const = 0;
  /// Why there is no connection; "" when there is one, or when the hub closed it.
  virtual const std::string& trouble() const = 0;
  virtual int64_t reconnects() const = 0;

  /// File descriptor for poll(); -1 while not connected.
  virtual int fd() const = 0;
  virtual bool wants_to_send() const = 0;
  /// Calls `sink` with messages that have arrived, with a bounded number of them per call.
  virtual void Receive(const std::function<void(const TcpqRecord&)>& sink) = 0;
  /// Queues a message for sending. While connected, no lossless message is rejected, so the caller
  /// must check full() before it adds the next one.
  virtual MessageQueue::Added Add(const RoutedMessage& message) = 0;
  virtual bool full() const = 0;
  virtual size_t queued_bytes() const = 0;
  virtual void Flush() = 0;
};

struct BridgeEndOptions {
  std::vector<std::string> channels;  ///< channels to subscribe to
  size_t queue_bytes = 0;             ///< see MessageQueue
};

/// Creates the end for a URL. If the hub does not run yet, KeepConnected connects later. For other
/// providers it fails when LCM cannot open the URL; the error names the command that solves the
/// problem.
Result<std::unique_ptr<BridgeEnd>> OpenBridgeEnd(const LcmUrl& url,
                                                 const BridgeEndOptions& options);

}  // namespace vismap
