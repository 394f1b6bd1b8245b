#include "map_server/map_publisher.h"

#include <utility>

namespace vismap {

MapPublisher::MapPublisher(const OutputOptions& options, const PublishPeriods& periods, Bus* bus,
                           Stopwatch watch)
    : occupancy_(options.free_space, bus),
      mesh_(options.meshing, bus),
      objects_(options, bus),
      mesh_pacer_(periods.mesh),
      objects_pacer_(periods.objects),
      watch_(std::move(watch)) {}

void MapPublisher::Start(const MapSession& session) {
  occupancy_.Start(session.map(), session.metadata().map_id);
  mesh_.Start(session.map(), session.metadata().map_id);
  objects_.Start();
}

void MapPublisher::PublishFrame(const MapSession& session, const MapDelta& delta) {
  watch_.Measure("publishing", [&] {
    occupancy_.PublishChanges(session.map(), delta.changed_blocks);
    mesh_.AddChanges(session.map(), delta);
  });
}

void MapPublisher::PublishIfDue(const MapSession& session, double share) {
  if (mesh_.has_changes()) mesh_pacer_.RunIfDue([&] { PublishMesh(session); }, share);
  if (objects_.has_changes(session.map()))
    objects_pacer_.RunIfDue([&] { PublishObjects(session); }, share);
}

void MapPublisher::PublishMesh(const MapSession& session) {
  watch_.Measure("meshing", [&] { mesh_.PublishChanges(session.map()); });
}

void MapPublisher::PublishObjects(const MapSession& session) {
  if (mesh_.has_changes()) PublishMesh(session);  // objects are read from the published surface
  watch_.Measure("objects", [&] { objects_.PublishChanges(session, mesh_.tracker()); });
}

const std::vector<ObjectSummary>& MapPublisher::FreshObjects(const MapSession& session) {
  if (objects_.has_changes(session.map())) PublishObjects(session);
  return objects_.objects();
}

void MapPublisher::PublishAll(const MapSession& session) {
  occupancy_.PublishSnapshot(session.map());
  mesh_.PublishAll(session.map());
  objects_.PublishAll(session);
}

void MapPublisher::Repeat(const MapSession& session) {
  occupancy_.Heartbeat();
  mesh_.Heartbeat(session.map());
  objects_.Repeat();
}

}  // namespace vismap
