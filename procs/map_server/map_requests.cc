#include "map_server/map_requests.h"

#include <string>

#include "map_server/answers.h"
#include "requests/octree_request.h"

namespace vismap {

MapRequests::MapRequests(const OutputOptions& options, LiveMap* map, Bus* bus, Status* status)
    : options_(options),
      map_(*map),
      server_(
          RequestReceiver::kMapServer,
          [map] {
            return FollowerPosition{map->session().metadata().map_id,
                                    map->session().map().revision};
          },
          bus, status) {
  using Request = map_request_t;
  server_.Handle("save", [this](const Request& request) { return Save(request); });
  server_.Handle("load", [this](const Request& request) { return Load(request); });
  server_.Handle("reset", [this](const Request&) { return Reset(); });
  server_.Handle("objects",
                 [this](const Request& request) { return PublishAndSelectObjects(request); });
  server_.Handle("mesh", [this](const Request& request) { return ReturnOrPublishMesh(request); });
  server_.Handle("snapshot", [this](const Request& request) { return PublishSpace(request); });
  server_.Handle("points", [this](const Request& request) { return ReturnObjects(request, true); });
  server_.Handle("octree", [this](const Request& request) { return ReturnOctree(request); });
  server_.Handle("occupancy", [this](const Request& request) -> Result<Answer> {
    const Result<EditedSpace> space = SpaceWithout(request);
    if (!space) return tl::unexpected(space.error());
    return AnswerOccupancy(*space);
  });
  server_.Handle("statistics", [this](const Request&) {
    return AnswerStatistics(map_.session(), map_.publisher().occupancy().Digest());
  });
  server_.Handle("map", [this](const Request&) { return AnswerMapFile(map_.session()); });
  server_.Handle("frames", [this](const Request& request) {
    return AnswerFrames(map_.session(), request.argument);
  });
}

Result<Answer> MapRequests::Save(const map_request_t& request) {
  const Result<std::string> saved =
      request.path.empty() ? map_.Save() : map_.SaveNamed(request.path);
  if (!saved) return tl::unexpected(saved.error());
  return Answer{*saved};
}

Result<Answer> MapRequests::Load(const map_request_t& request) {
  const Result<std::string> loaded = map_.LoadNamed(request.path);
  if (!loaded) return tl::unexpected(loaded.error());
  map_.PublishAll();
  return Answer{*loaded};
}

Result<Answer> MapRequests::Reset() {
  map_.Reset();
  map_.PublishAll();
  return Answer{"the map is empty now; it is map " + map_.session().metadata().map_id};
}

Result<Answer> MapRequests::PublishAndSelectObjects(const map_request_t& request) {
  const Result<ObjectQuery> query = QueryOf(request);
  if (!query) return tl::unexpected(query.error());
  ObjectsPublisher& publisher = map_.publisher().objects();
  const std::vector<ObjectSummary> objects = publisher.PublishAll(map_.session());
  return AnswerObjects(map_.session(), *query, publisher.up(), objects);
}

Result<Answer> MapRequests::ReturnOrPublishMesh(const map_request_t& request) {
  if (request.argument.find('=') != std::string::npos) return ReturnObjects(request, false);
  if (request.argument == "ply") return AnswerMeshFile(map_.session(), options_);
  if (request.argument == "digest") {
    map_.publisher().PublishMesh(map_.session());
    return Answer{MeshPublisher::DigestOf(map_.session().map(), options_.meshing)};
  }
  const Result<FollowerPosition> position = ParseFollowerPosition(request.argument);
  if (!position)
    return Fail("argument of mesh: ply, digest, id=7 or class=NAME for objects, or a " +
                position.error().message);
  map_.publisher().mesh().PublishSince(map_.session().map(), *position);
  return Answer{"published on " + std::string(kMeshDeltaChannel.name)};
}

// The objects as they were published last, from which clients know their ids.
const std::vector<ObjectSummary>& MapRequests::Objects() {
  ObjectsPublisher& publisher = map_.publisher().objects();
  if (publisher.objects().empty()) publisher.PublishAll(map_.session());
  return publisher.objects();
}

Result<Answer> MapRequests::ReturnObjects(const map_request_t& request, bool points_only) {
  const Result<ObjectQuery> query = QueryOf(request);
  if (!query) return tl::unexpected(query.error());
  const auto selected = SelectObjects(Objects(), *query);
  if (!selected) return tl::unexpected(selected.error());
  const LabelPlaces& places = map_.publisher().mesh().tracker().places();
  return AnswerSurface(map_.session(), *selected, places, options_.meshing, points_only);
}

Result<EditedSpace> MapRequests::SpaceWithout(const map_request_t& request) {
  const LabelPlaces& places = map_.publisher().mesh().tracker().places();
  return EditSpace(
      map_.session().map(), Objects(), [&](SegmentLabel label) { return places.BlocksOf(label); },
      request.without, options_.free_space);
}

Result<Answer> MapRequests::ReturnOctree(const map_request_t& request) {
  const MapSession& session = map_.session();
  if (request.without.empty())
    return AnswerMapOctree(session.map(), session.metadata(), request, options_);
  const Result<EditedSpace> space = SpaceWithout(request);
  if (!space) return tl::unexpected(space.error());
  return AnswerMapOctree(session.map(), session.metadata(), request, options_, &space->delta);
}

Result<Answer> MapRequests::PublishSpace(const map_request_t& request) {
  const Result<FollowerPosition> position = ParseFollowerPosition(request.argument);
  if (!position) return Fail("argument of snapshot: " + position.error().message);
  OccupancyPublisher& occupancy = map_.publisher().occupancy();
  occupancy.PublishSince(map_.session().map(), *position);
  return Answer{occupancy.Digest()};
}

}  // namespace vismap
