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

/// A connection to a bus that carries byte strings on named channels. For use by one thread; the
/// sink may call Publish.
class Transport {
 public:
  using Sink = std::function<void(const std::string& channel, std::span<const uint8_t> data)>;

  virtual ~Transport() = default;
  /// False once the connection has ended; it is not opened again.
  virtual bool connected() const = 0;
  /// File descriptor that is readable when data has arrived; -1 when not connected.
  virtual int fd() const = 0;
  /// A message has been read already and waits for Receive, even if fd() is not readable.
  virtual bool pending() const = 0;
  /// Subscribes to a channel (a regular expression).
  virtual void Subscribe(const std::string& channel) = 0;
  /// Returns false when the message could not be sent.
  virtual bool Publish(const std::string& channel, std::span<const uint8_t> data) = 0;
  /// Reads the data that has arrived, without waiting, and calls `sink` with at most one message.
  /// `sink` must not throw. Returns true when it was called.
  virtual bool Receive(const Sink& sink) = 0;
  /// Reads some of the data that has arrived and keeps it for Receive, within limits. Afterwards
  /// connected() is false when the other side has ended the connection.
  virtual void ReadAhead() {}
};

/// vismap's own client for a hub (tcpq). It sends a message with one call, bounds every wait, and
/// receives while it sends, so that hub and client cannot wait for each other forever. `stop` (may
/// be nullptr) shortens the waits.
Result<std::unique_ptr<Transport>> OpenTcpqTransport(const TcpAddress& hub, const StopSignal* stop);

/// LCM's own implementation, for udpm, memq and all other providers. Another thread may call
/// Publish meanwhile.
Result<std::unique_ptr<Transport>> OpenLcmTransport(const LcmUrl& url);

}  // namespace vismap
