#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vismap/map_delta_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/process_status_t.hpp>

#include "hub/hub.h"
#include "runtime/bus.h"
#include "runtime/clock.h"

namespace vismap {

// Longest wait, far more than needed on an idle machine [s].
inline constexpr double kDeadline = 30;

/// A hub that runs in its own thread, on a free port unless one is given.
class RunningHub {
 public:
  explicit RunningHub(HubOptions options = {}, uint16_t port = 0, const FaultOptions& faults = {}) {
    options.listen = "127.0.0.1:" + std::to_string(port);
    auto opened = Hub::Open(options, "", faults);
    if (!opened) throw std::runtime_error(opened.error().message);
    hub_ = std::move(*opened);
    thread_ = std::thread([this] { hub_->Run(stop_); });
  }
  ~RunningHub() { Stop(); }
  /// Stops the hub, so that its counters may be read.
  void Stop() {
    stop_.Request();
    if (thread_.joinable()) thread_.join();
  }
  uint16_t port() const { return hub_->port(); }
  std::string url() const { return "tcpq://127.0.0.1:" + std::to_string(port()); }
  const HubCounters& counters() const { return hub_->counters(); }

 private:
  StopSignal stop_;
  std::unique_ptr<Hub> hub_;
  std::thread thread_;
};

inline std::unique_ptr<Bus> Join(const RunningHub& hub, const std::string& source) {
  BusOptions options;
  options.url = hub.url();
  options.source = source;
  auto bus = Bus::Open(options);
  EXPECT_TRUE(bus) << bus.error().message;
  return std::move(*bus);
}

/// Tells the hub the name of a bus, as processes do with their STATUS.
inline void Introduce(Bus* bus) {
  process_status_t introduction{};
  EXPECT_TRUE(bus->Publish(kStatusChannel, introduction));
}

template <typename Condition>
bool SpinUntil(Bus* bus, const Condition& condition) {
  const double deadline = MonotonicSeconds() + kDeadline;
  while (!condition() && MonotonicSeconds() < deadline) bus->Spin(0.05);
  return condition();
}

/// Waits until the hub has handled everything that this bus has sent so far: it sends a request to
/// itself and waits for it.
inline void Settle(Bus* bus) {
  static std::atomic<int64_t> next{1};
  const int64_t id = next++;
  auto seen = std::make_shared<bool>(false);
  bus->Subscribe<map_request_t>(kMapRequestChannel, [seen, id](const map_request_t& request) {
    if (request.request_id == id) *seen = true;
  });
  map_request_t request{};
  request.request_id = id;
  bus->Publish(kMapRequestChannel, request);
  ASSERT_TRUE(SpinUntil(bus, [&] { return *seen; }));
}

inline map_delta_t Delta(int64_t revision, size_t bytes) {
  map_delta_t delta{};
  delta.revision = revision;
  delta.payload.assign(bytes, static_cast<uint8_t>(revision));
  delta.payload_size = static_cast<int32_t>(bytes);
  return delta;
}

}  // namespace vismap
