#include "adapter/robot_bus.h"

#include <poll.h>

#include <chrono>
#include <thread>
#include <utility>

#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/self_check.h"
#include "runtime/stop_signal.h"

namespace vismap {
namespace {

constexpr double kRetryPeriod = 0.5;  // [s]
constexpr int kMessagesPerTurn = 64;

void Sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

}  // namespace

Result<std::unique_ptr<RobotBus>> RobotBus::Open(const std::string& url,
                                                 const std::set<std::string>& channels,
                                                 double timeout, const StopSignal* stop) {
  Result<LcmUrl> parsed = ParseLcmUrl(url);
  if (!parsed) return Fail("adapter.robot_url: " + parsed.error().message);
  std::unique_ptr<RobotBus> bus(new RobotBus(std::move(*parsed), channels, stop));
  const double deadline = MonotonicSeconds() + timeout;
  while (true) {
    const Result<void> connected = bus->Connect();
    if (connected) return bus;
    if (bus->url_.provider != "tcpq" || stop->requested() || MonotonicSeconds() > deadline)
      return Fail("the robot's bus at " + url + ": " + connected.error().message);
    Sleep(kRetryPeriod);
  }
}

Result<void> RobotBus::Connect() {
  Result<std::unique_ptr<Transport>> transport =
      url_.provider == "tcpq" ? OpenTcpqTransport(url_.hub, stop_) : OpenLcmTransport(url_);
  if (!transport) return tl::unexpected(transport.error());
  transport_ = std::move(*transport);
  for (const std::string& channel : channels_) transport_->Subscribe(channel);
  return {};
}

void RobotBus::KeepConnected() {
  if (connected() || MonotonicSeconds() < next_attempt_) return;
  if (transport_) LogWarning("the connection to the robot's bus at " + url_.text + " was lost");
  transport_.reset();
  if (Connect()) {
    ++reconnects_;
    LogInfo("connected to the robot's bus at " + url_.text + " again");
  }
  next_attempt_ = MonotonicSeconds() + kRetryPeriod;
}

bool RobotBus::Spin(double timeout, const Transport::Sink& sink) {
  KeepConnected();
  if (!connected()) {
    Sleep(timeout);
    return true;
  }
  const auto has_arrived = [this](double seconds) {
    pollfd waiting{transport_->fd(), POLLIN, 0};
    return transport_->pending() || poll(&waiting, 1, static_cast<int>(seconds * 1000)) > 0;
  };
  if (!has_arrived(timeout)) return true;
  for (int i = 0; i < kMessagesPerTurn && transport_->Receive(sink); ++i) {
  }
  return !connected() || !has_arrived(0);
}

std::vector<std::string> RobotBus::Problems() const {
  std::vector<std::string> problems = BusProblems(url_);
  for (std::string& problem : problems)
    problem = "the robot's bus at " + url_.text + ": " + problem;
  return problems;
}

bool RobotBus::Publish(const std::string& channel, std::span<const uint8_t> data) {
  return connected() && transport_->Publish(channel, data);
}

}  // namespace vismap
