#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "queueing/message_queue.h"
#include "runtime/lcm_url.h"
#include "runtime/tcpq_records.h"

namespace vismap {

/// One of the two buses that a bridge joins. Nothing here waits, but for a second while a hub does
/// not answer.
class BridgeEnd {
 public:
  virtual ~BridgeEnd() = default;

  virtual const std::string& url() const = 0;
  /// Joins the bus again when that is due.
  virtual void KeepConnected() = 0;
  virtual bool connected() const = 0;
  /// Why it is not connected; empty when it is.
  virtual const std::string& trouble() const = 0;
  virtual int64_t reconnects() const = 0;

  /// To be polled; -1 while not connected.
  virtual int fd() const = 0;
  virtual bool wants_to_send() const = 0;
  /// Gives what has arrived, not all at once.
  virtual void Receive(const std::function<void(const TcpqRecord&)>& sink) = 0;
  /// Takes a message to be sent. While connected, nothing lossless is refused: whoever adds looks
  /// at full() before the next one.
  virtual MessageQueue::Added Add(const RoutedMessage& message) = 0;
  virtual bool full() const = 0;
  virtual size_t queued_bytes() const = 0;
  virtual void Flush() = 0;
};

struct BridgeEndOptions {
  std::vector<std::string> channels;  ///< to be received
  size_t queue_bytes = 0;             ///< see MessageQueue
};

/// Joins a bus. A hub that is not there yet is waited for, by KeepConnected. Fails when LCM cannot
/// open the URL, with the command that mends it.
Result<std::unique_ptr<BridgeEnd>> OpenBridgeEnd(const LcmUrl& url,
                                                 const BridgeEndOptions& options);

}  // namespace vismap
