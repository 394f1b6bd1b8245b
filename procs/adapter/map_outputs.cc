#include "adapter/map_outputs.h"

#include <utility>
#include <vismap/map_delta_t.hpp>
#include <vismap/mesh_delta_t.hpp>
#include <vismap/object_list_t.hpp>

#include "runtime/clock.h"
#include "wire/object_list.h"

namespace vismap {
namespace {

bool WantsSurface(const AdapterOptions& options) {
  return !options.cloud_channel.empty() || !options.detections_channel.empty() ||
         !options.drake_cloud_channel.empty() || !options.drake_objects_channel.empty() ||
         !options.director_channel.empty();
}

bool WantsSpace(const AdapterOptions& options) { return !options.costmap_channel.empty(); }

}  // namespace

bool MapOutputs::Wanted(const AdapterOptions& options) {
  return WantsSurface(options) || WantsSpace(options);
}

MapOutputs::MapOutputs(const AdapterOptions& options, size_t most_bytes, Bus* bus,
                       OutputReport* report, FittedOutputs::Send send)
    : options_(options),
      bus_(bus),
      report_(report),
      outputs_(options, most_bytes, report, std::move(send),
               [bus] { return bus->stop_requested(); }),
      mesh_catch_up_(bus, "mesh"),
      space_catch_up_(bus, "snapshot"),
      surface_pacer_(options.publish_period_s),
      space_pacer_(options.publish_period_s) {
  if (WantsSurface(options_)) {
    bus_->Subscribe<mesh_delta_t>(kMeshDeltaChannel,
                                  [this](const mesh_delta_t& message) { return OnMesh(message); });
    bus_->Subscribe<object_list_t>(
        kObjectsChannel,
        [this](const object_list_t& message) -> Result<void> {
          Result<ObjectList> list = Decode(message);
          if (!list) return tl::unexpected(list.error());
          objects_ = std::move(list->objects);
          objects_utime_ = list->utime;
          objects_changed_ = true;
          return {};
        },
        Delivery::kLatest);
    mesh_catch_up_.Request(mesh_.position());
  }
  if (WantsSpace(options_)) {
    bus_->Subscribe<map_delta_t>(kMapDeltaChannel,
                                 [this](const map_delta_t& message) { return OnSpace(message); });
    space_catch_up_.Request(space_.position());
  }
  bus_->Every(0.2, [this] { OnTimer(); });
}

Result<void> MapOutputs::OnMesh(const mesh_delta_t& message) {
  switch (mesh_.Apply(message, MonotonicSeconds())) {
    case FollowOutcome::kNeedsSnapshot:
      mesh_catch_up_.Request(mesh_.position());
      return {};
    case FollowOutcome::kBroken:
      return Fail("the update to revision " + std::to_string(message.revision) +
                  " is inconsistent");
    case FollowOutcome::kTooLarge:
      return Fail("the surface needs more memory than a follower takes");
    default:
      return {};
  }
}

Result<void> MapOutputs::OnSpace(const map_delta_t& message) {
  Result<MapUpdate> update = Decode(message);
  if (!update) return tl::unexpected(update.error());
  switch (space_.Apply(std::move(*update), MonotonicSeconds())) {
    case FollowOutcome::kNeedsSnapshot:
    case FollowOutcome::kBroken:
      space_catch_up_.Request(space_.position());
      return {};
    case FollowOutcome::kTooLarge:
      return Fail("the space needs more memory than a follower takes");
    default:
      return {};
  }
}

void MapOutputs::OnTimer() {
  mesh_.GiveUpStaleParts(MonotonicSeconds());
  space_.GiveUpStaleParts(MonotonicSeconds());
  if (WantsSurface(options_) && !mesh_.in_sync()) mesh_catch_up_.Request(mesh_.position());
  if (WantsSpace(options_) && !space_.in_sync()) space_catch_up_.Request(space_.position());
  if (mesh_.in_sync() && (mesh_.position() != surface_published_ || objects_changed_))
    surface_pacer_.RunIfDue([this] { PublishSurface(); });
  if (space_.in_sync() && space_.occupancy() && space_.position() != space_published_)
    space_pacer_.RunIfDue([this] { PublishSpace(); });
}

void MapOutputs::PublishSurface() {
  const double start = MonotonicSeconds();
  surface_published_ = mesh_.position();
  objects_changed_ = false;
  outputs_.PublishSurface(mesh_.Joined(), mesh_.utime(), objects_, objects_utime_);
  report_->AddTiming("surface for others", (MonotonicSeconds() - start) * 1e3);
}

void MapOutputs::PublishSpace() {
  const double start = MonotonicSeconds();
  space_published_ = space_.position();
  outputs_.PublishSpace(*space_.occupancy(), space_.utime());
  report_->AddTiming("space for others", (MonotonicSeconds() - start) * 1e3);
}

OutputThread::OutputThread(const AdapterOptions& options, std::unique_ptr<Bus> bus,
                           std::unique_ptr<RobotBus> robot, StopSignal* stop)
    : options_(options),
      bus_(std::move(bus)),
      robot_(std::move(robot)),
      stop_(stop),
      thread_([this] {
        try {
          Run();
        } catch (...) {
          report_.Fail(std::current_exception());
        }
      }) {}

OutputThread::~OutputThread() {
  stop_->Request();
  thread_.join();
}

void OutputThread::Run() {
  constexpr double kTurn = 0.1, kReportPeriod = 0.5;  // [s]
  const MapOutputs outputs(options_, LargestOutput(robot_->parsed_url()), bus_.get(), &report_,
                           [this](const std::string& channel, std::span<const uint8_t> bytes) {
                             return robot_->Publish(channel, bytes);
                           });
  bus_->Every(kReportPeriod, [this] { ReportBus(); });
  while (!stop_->requested()) {
    robot_->KeepConnected();
    bus_->Spin(kTurn);
  }
}

// The STATUS has the counters of the other connection by itself.
void OutputThread::ReportBus() {
  for (const auto& [channel, counters] : bus_->counters()) {
    report_.SetCounter(channel + ".received", counters.received);
    report_.SetCounter(channel + ".rejected", counters.rejected);
    report_.SetCounter(channel + ".lost", counters.lost);
  }
}

}  // namespace vismap
