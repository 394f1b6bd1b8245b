#include "client/client.h"

#include <stdexcept>
#include <utility>
#include <vismap/detections_t.hpp>
#include <vismap/distance_field_t.hpp>
#include <vismap/frame_commit_t.hpp>
#include <vismap/map_delta_t.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/mesh_delta_t.hpp>
#include <vismap/navigation_status_t.hpp>
#include <vismap/object_list_t.hpp>
#include <vismap/occupancy_grid_t.hpp>
#include <vismap/octree_delta_t.hpp>
#include <vismap/octree_t.hpp>
#include <vismap/process_status_t.hpp>
#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "runtime/bus.h"
#include "runtime/frame_lag.h"
#include "runtime/status.h"
#include "wire/channel_types.h"

namespace vismap {
namespace {

std::unique_ptr<Bus> OpenBus(const ClientOptions& options) {
  BusOptions bus;
  if (!options.url.empty()) bus.url = options.url;
  bus.source = options.name;
  bus.connect_timeout = options.connect_timeout_s;
  bus.channel_prefix = options.channel_prefix;
  Result<std::unique_ptr<Bus>> opened = Bus::Open(bus);
  if (!opened) throw std::runtime_error(opened.error().message);
  return std::move(*opened);
}

template <typename Message>
Channel ChannelFor(const std::string& name) {
  std::string expected;
  for (const ChannelType& type : ChannelTypes()) {
    if (type.fingerprint != Message::getHash()) continue;
    if (name == type.channel.name) return type.channel;
    expected = type.channel.name;
  }
  throw std::invalid_argument("channel " + name + ": vismap's " + Message::getTypeName() +
                              " is on channel " + expected);
}

}  // namespace

struct Client::Parts {
  explicit Parts(const ClientOptions& options)
      : bus(OpenBus(options)), status(bus.get(), options.name) {
    status.Set(ProcessState::kReady);
  }

  std::unique_ptr<Bus> bus;
  Status status;
};

Client::Client(const ClientOptions& options) : parts_(std::make_unique<Parts>(options)) {}
Client::~Client() { parts_->status.Set(ProcessState::kStopping); }

template <typename Message>
void Client::Subscribe(const std::string& channel, std::function<void(const Message&)> handler,
                       bool latest) {
  parts_->bus->Subscribe<Message>(ChannelFor<Message>(channel), std::move(handler),
                                  latest ? Delivery::kLatest : Delivery::kEvery);
}

template <typename Message>
bool Client::Publish(const std::string& channel, Message message) {
  return parts_->bus->Publish(ChannelFor<Message>(channel), std::move(message));
}

bool Client::Handle(double timeout_s) { return parts_->bus->Spin(timeout_s); }
bool Client::connected() const { return parts_->bus->connected(); }

ClientCounters Client::counters(const std::string& channel) const {
  const auto found = parts_->bus->counters().find(channel);
  if (found == parts_->bus->counters().end()) return {};
  const ChannelCounters& totals = found->second;
  return {totals.received, totals.rejected, totals.lost, totals.unsent};
}

void Client::SetRunning() { parts_->status.Set(ProcessState::kRunning); }
void Client::SetWaiting(const std::string& sentence) {
  parts_->status.Set(ProcessState::kWaiting, sentence);
}
void Client::Count(const std::string& counter, int64_t amount) {
  parts_->status.Count(counter, amount);
}
void Client::SetCounter(const std::string& counter, int64_t value) {
  parts_->status.SetCounter(counter, value);
}
void Client::AddTiming(const std::string& stage, double ms) { parts_->status.AddTiming(stage, ms); }
void Client::SawFrame(int camera_id, int64_t utime) {
  SetCounter(kNewestUtimeCounter + std::to_string(camera_id), utime);
}
void Client::SetFindings(const std::string& subject, const std::vector<std::string>& sentences) {
  parts_->status.SetFindings(subject, sentences);
}

#define VISMAP_CLIENT_MESSAGE(Message)                                                 \
  template void Client::Subscribe<Message>(const std::string&,                         \
                                           std::function<void(const Message&)>, bool); \
  template bool Client::Publish<Message>(const std::string&, Message);
VISMAP_CLIENT_MESSAGE(rgbd_frame_t)
VISMAP_CLIENT_MESSAGE(detections_t)
VISMAP_CLIENT_MESSAGE(segmented_frame_t)
VISMAP_CLIENT_MESSAGE(frame_commit_t)
VISMAP_CLIENT_MESSAGE(map_delta_t)
VISMAP_CLIENT_MESSAGE(mesh_delta_t)
VISMAP_CLIENT_MESSAGE(object_list_t)
VISMAP_CLIENT_MESSAGE(octree_t)
VISMAP_CLIENT_MESSAGE(octree_delta_t)
VISMAP_CLIENT_MESSAGE(occupancy_grid_t)
VISMAP_CLIENT_MESSAGE(distance_field_t)
VISMAP_CLIENT_MESSAGE(navigation_status_t)
VISMAP_CLIENT_MESSAGE(map_request_t)
VISMAP_CLIENT_MESSAGE(map_reply_t)
VISMAP_CLIENT_MESSAGE(process_status_t)
#undef VISMAP_CLIENT_MESSAGE

}  // namespace vismap
