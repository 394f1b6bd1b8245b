#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/result.h"
#include "runtime/clock.h"
#include "runtime/stop_signal.h"
#include "runtime/transport.h"

namespace vismap {

/// Calls `open`, which returns a Result, until it succeeds, for at most `timeout` [s] and until
/// `stop` is requested. Returns what it returned last.
template <typename Open>
auto OpenWithin(double timeout, const StopSignal& stop, const Open& open) {
  constexpr double kPeriod = 0.1;  // [s]
  const double deadline = MonotonicSeconds() + timeout;
  for (;;) {
    auto opened = open();
    if (opened || MonotonicSeconds() >= deadline || stop.WaitFor(kPeriod)) return opened;
  }
}

/// The bus of a robot, whose messages are not ours: bytes on channels. It connects again when a hub
/// was restarted. For use by one thread.
class RobotBus {
 public:
  /// `channels`: regular expressions to subscribe to. Waits up to `timeout` [s] for a hub. Fails
  /// when the URL is wrong or nothing answers.
  static Result<std::unique_ptr<RobotBus>> Open(const std::string& url,
                                                const std::set<std::string>& channels,
                                                double timeout, const StopSignal* stop);

  /// Waits up to `timeout` [s] for a message, and hands what has arrived to `sink`, at most 64
  /// messages. Returns false when more has arrived.
  bool Spin(double timeout, const Transport::Sink& sink);
  /// Returns false when there is no connection.
  bool Publish(const std::string& channel, std::span<const uint8_t> data);

  bool connected() const { return transport_ && transport_->connected(); }
  const std::string& url() const { return url_.text; }
  const LcmUrl& parsed_url() const { return url_; }
  int64_t reconnects() const { return reconnects_; }
  /// Connects again when the connection has ended, at most twice a second; Spin does it, too.
  void KeepConnected();
  /// What this computer lacks for the bus, as BusProblems finds it.
  std::vector<std::string> Problems() const;

 private:
  RobotBus(LcmUrl url, std::set<std::string> channels, const StopSignal* stop)
      : url_(std::move(url)), channels_(std::move(channels)), stop_(stop) {}
  Result<void> Connect();

  LcmUrl url_;
  std::set<std::string> channels_;
  const StopSignal* stop_;
  std::unique_ptr<Transport> transport_;
  double next_attempt_ = 0;  // MonotonicSeconds
  int64_t reconnects_ = 0;
};

}  // namespace vismap
