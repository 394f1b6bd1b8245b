#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "base/result.h"
#include "runtime/lcm_url.h"
#include "runtime/stop_signal.h"

namespace vismap {

/// One connection to a bus that carries named byte strings. For one thread; Publish may be called
/// from within the sink.
class Transport {
 public:
  using Sink = std::function<void(const std::string& channel, std::span<const uint8_t> data)>;

  virtual ~Transport() = default;
  /// False after the connection has ended; it then stays so.
  virtual bool connected() const = 0;
  /// Readable when something has arrived; -1 when not connected.
  virtual int fd() const = 0;
  /// Something has been read and waits for Receive, whatever fd() says.
  virtual bool pending() const = 0;
  /// Messages of this channel are to come.
  virtual void Subscribe(const std::string& channel) = 0;
  /// False when the message could not be handed over.
  virtual bool Publish(const std::string& channel, std::span<const uint8_t> data) = 0;
  /// Takes what has arrived, without waiting, and gives at most one message to `sink`, which must
  /// not throw. True when it gave one.
  virtual bool Receive(const Sink& sink) = 0;
};

/// Our own client of a hub (tcpq): sends a message in one piece, never waits without limit, and
/// goes on receiving while it sends, so that a hub which waits for us cannot lock us up. `stop`
/// (may be nullptr) cuts waiting short.
Result<std::unique_ptr<Transport>> OpenTcpqTransport(const TcpAddress& hub, const StopSignal* stop);

/// LCM's own implementation, for udpm, memq and the others.
Result<std::unique_ptr<Transport>> OpenLcmTransport(const LcmUrl& url);

}  // namespace vismap
