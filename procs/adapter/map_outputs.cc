#include "adapter/map_outputs.h"

#include <vismap/map_delta_t.hpp>
#include <vismap/mesh_delta_t.hpp>
#include <vismap/object_list_t.hpp>

#include "base/class_names.h"
#include "foreign/map_messages.h"
#include "foreign/presets.h"
#include "objects/object_mesh.h"
#include "runtime/clock.h"
#include "wire/object_list.h"

namespace vismap {

MapOutputs::MapOutputs(const AdapterOptions& options, Bus* bus, Status* status, RobotBus* robot)
    : options_(options),
      root_(CamerasOf(options).front().root),
      bus_(bus),
      status_(status),
      robot_(robot),
      mesh_catch_up_(bus, "mesh"),
      space_catch_up_(bus, "snapshot"),
      surface_pacer_(options.publish_period_s),
      space_pacer_(options.publish_period_s) {
  if (WantsSurface()) {
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
  if (!options_.costmap_channel.empty()) {
    bus_->Subscribe<map_delta_t>(kMapDeltaChannel,
                                 [this](const map_delta_t& message) { return OnSpace(message); });
    space_catch_up_.Request(space_.position());
  }
  if (WantsSurface() || !options_.costmap_channel.empty()) bus_->Every(0.2, [this] { OnTimer(); });
}

bool MapOutputs::WantsSurface() const {
  return !options_.cloud_channel.empty() || !options_.detections_channel.empty() ||
         !options_.drake_cloud_channel.empty() || !options_.drake_objects_channel.empty() ||
         !options_.director_channel.empty();
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
  if (WantsSurface() && !mesh_.in_sync()) mesh_catch_up_.Request(mesh_.position());
  if (!options_.costmap_channel.empty() && !space_.in_sync())
    space_catch_up_.Request(space_.position());
  if (mesh_.in_sync() && (mesh_.position() != surface_published_ || objects_changed_))
    surface_pacer_.RunIfDue([this] { PublishSurface(); });
  if (space_.in_sync() && space_.occupancy() && space_.position() != space_published_)
    space_pacer_.RunIfDue([this] { PublishSpace(); });
}

template <typename Message>
void MapOutputs::Send(const std::string& channel, Message message) {
  if (channel.empty()) return;
  const RawBytes bytes = PackRaw(message);
  status_->Count(robot_->Publish(channel, bytes) ? "map_messages_published"
                                                 : "map_messages_unsent");
}

void MapOutputs::PublishSurface() {
  const StageTimer timer(status_, "surface for others");
  surface_published_ = mesh_.position();
  objects_changed_ = false;
  const Mesh mesh = mesh_.Joined();
  const std::vector<SurfacePoint> points = ThinOut(mesh, options_.cloud_spacing_m);
  const int64_t utime = mesh_.utime();
  const std::string& frame = root_;
  if (!options_.cloud_channel.empty())
    Send(options_.cloud_channel, ToPointCloud2(points, frame, utime));
  if (!options_.detections_channel.empty())
    Send(options_.detections_channel, ToDetections(objects_, ClassName, frame, objects_utime_));
  if (!options_.drake_cloud_channel.empty())
    Send(options_.drake_cloud_channel, ToDrakeCloud(points, frame, utime));
  if (!options_.drake_objects_channel.empty())
    Send(options_.drake_objects_channel,
         ToDeformable(objects_, CutObjects(mesh, objects_), ClassName));
  if (!options_.director_channel.empty()) {
    Send(options_.director_channel,
         ToTreeviewer(points, objects_, ClassName, utime, &boxes_in_director_));
  }
}

void MapOutputs::PublishSpace() {
  const StageTimer timer(status_, "space for others");
  space_published_ = space_.position();
  Result<foreign::nav_msgs::OccupancyGrid> costmap =
      ToCostmap(*space_.occupancy(),
                {options_.costmap_resolution_m, options_.costmap_min_z_m, options_.costmap_max_z_m,
                 options_.costmap_unknown},
                root_, space_.utime());
  status_->SetFinding("costmap", costmap ? std::nullopt : std::optional(costmap.error().message));
  if (costmap) Send(options_.costmap_channel, std::move(*costmap));
}

}  // namespace vismap
