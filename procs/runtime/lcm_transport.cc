#include <poll.h>

#include <lcm/lcm-cpp.hpp>

#include "runtime/transport.h"

namespace vismap {
namespace {

// Messages of a channel that LCM holds while the process is busy; it drops the newest beyond. LCM
// does not limit their bytes, but takes no message above 16 MB.
constexpr int kMaxQueued = 256;

class LcmTransport : public Transport {
 public:
  explicit LcmTransport(const std::string& url) : lcm_(url) {}

  bool connected() const override { return const_cast<lcm::LCM&>(lcm_).good(); }
  int fd() const override { return const_cast<lcm::LCM&>(lcm_).getFileno(); }
  bool pending() const override { return false; }

  void Subscribe(const std::string& channel) override {
    lcm::Subscription* subscription =
        lcm_.subscribeFunction(channel, &LcmTransport::OnMessage, this);
    if (subscription != nullptr) subscription->setQueueCapacity(kMaxQueued);
  }

  bool Publish(const std::string& channel, std::span<const uint8_t> data) override {
    return lcm_.publish(channel, data.data(), static_cast<unsigned>(data.size())) == 0;
  }

  bool Receive(const Sink& sink) override {
    pollfd waiting{fd(), POLLIN, 0};
    if (poll(&waiting, 1, 0) != 1) return false;
    sink_ = &sink;
    received_ = false;
    lcm_.handle();
    return received_;
  }

 private:
  static void OnMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel,
                        LcmTransport* self) {
    self->received_ = true;
    (*self->sink_)(channel, {static_cast<const uint8_t*>(buffer->data), buffer->data_size});
  }

  lcm::LCM lcm_;
  const Sink* sink_ = nullptr;
  bool received_ = false;
};

}  // namespace

Result<std::unique_ptr<Transport>> OpenLcmTransport(const LcmUrl& url) {
  auto transport = std::make_unique<LcmTransport>(url.text);
  if (transport->connected()) return transport;
  return Fail("LCM cannot open " + url.text +
              (url.provider == "udpm"
                   ? "; if there is no multicast route, run: sudo ip route add 224.0.0.0/4 dev lo"
                   : "; check the URL"));
}

}  // namespace vismap
