#include "map_server/map_requests.h"

#include <exception>
#include <new>
#include <string>
#include <utility>

#include "map_server/answers.h"
#include "requests/octree_request.h"
#include "runtime/clock.h"

namespace vismap {
namespace {

/// The blocks with votes for some objects; some may be listed twice.
std::vector<BlockIndex> PlacesOf(std::span<const ObjectSummary> objects, const LabelTable& labels,
                                 const LabelPlaces& places) {
  std::vector<BlockIndex> blocks;
  for (const ObjectSummary& object : objects) {
    for (const SegmentLabel segment : object.segments) {
      const std::span<const BlockIndex> more = places.BlocksOf(labels.Canonical(segment));
      blocks.insert(blocks.end(), more.begin(), more.end());
    }
  }
  return blocks;
}

/// The surface of objects of a map of which none were published yet.
Result<Answer> AnswerUnknownSurface(const MapSnapshot& map, const ObjectQuery& query,
                                    const OutputOptions& options, bool points_only) {
  const auto selected = SelectObjects(MakeProducts(map.map, map.metadata, options).objects, query);
  if (!selected) return tl::unexpected(selected.error());
  LabelPlaces places;
  places.AddBlocks(map.map.voxels, map.map.voxels.SortedIndices());
  places.MergeAll(map.map.labels);
  return AnswerSurface(map, *selected, PlacesOf(*selected, map.map.labels, places), options.meshing,
                       points_only);
}

/// The answer, or why there is none. A map may be too large for what was asked for.
template <typename Function>
Result<Answer> Guarded(const Function& answer, const MapSnapshot& map) {
  try {
    return answer(map);
  } catch (const std::bad_alloc&) {
    return Fail("there is not enough memory for the answer");
  } catch (const std::exception& error) {
    return Fail(std::string("the answer could not be made: ") + error.what());
  }
}

}  // namespace

MapRequests::MapRequests(const OutputOptions& options, LiveMap* map, Bus* bus, Status* status)
    : options_(options),
      map_(*map),
      bus_(*bus),
      server_(
          RequestReceiver::kMapServer,
          [map] {
            return FollowerPosition{map->session().metadata().map_id,
                                    map->session().map().revision};
          },
          bus, status),
      worker_(bus) {
  // The other thread makes one answer at a time. What has not begun holds no copy of the map, and
  // waits within the limits of the server.
  server_.SetMostBegun(1);
  server_.JoinEqual([](const map_request_t& request) {
    return (request.verb == "snapshot" || request.verb == "mesh") &&
           ParseFollowerPosition(request.argument);
  });
  server_.Handle("load", [this](const map_request_t& request) { return Load(request); });
  server_.Handle("reset", [this](const map_request_t&) { return Reset(); });
  HandleReading("save", &MapRequests::Save);
  HandleReading("objects", &MapRequests::ReadObjects);
  HandleReading("mesh", &MapRequests::ReadMesh);
  HandleReading("snapshot", &MapRequests::ReadSpaceGap);
  HandleReading("points", &MapRequests::ReadPoints);
  HandleReading("octree", &MapRequests::ReadOctree);
  HandleReading("occupancy", &MapRequests::ReadOccupancy);
  HandleReading("statistics", &MapRequests::ReadStatistics);
  HandleReading("map", &MapRequests::ReadMap);
  HandleReading("frames", &MapRequests::ReadFrames);
  HandleReading("cell", &MapRequests::ReadCell);
}

void MapRequests::HandleReading(const std::string& verb,
                                Result<Reading> (MapRequests::*prepare)(const map_request_t&)) {
  server_.HandleLate(
      verb, [this, prepare](const map_request_t& request, const RequestServer::Reply& reply) {
        Result<Reading> reading = (this->*prepare)(request);
        if (!reading) return reply(tl::unexpected(reading.error()));
        Read(std::move(*reading), reply);
      });
}

void MapRequests::Read(Reading reading, const RequestServer::Reply& reply) {
  const std::shared_ptr<MapSnapshot> map = map_.Snapshot();
  const auto work = [answer = std::move(reading.answer), map] {
    const double start = MonotonicSeconds();
    const auto complete = [&](const MapSnapshot&) {
      map->Complete();
      return answer(*map);
    };
    LateAnswer made = Guarded(complete, *map);
    made.position = map->position();
    made.worked_s = MonotonicSeconds() - start;
    return made;
  };
  worker_.Start(work, [then = std::move(reading.then), map, reply](LateAnswer made) {
    if (then) then(*map);
    reply(std::move(made));
  });
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

Result<MapRequests::Reading> MapRequests::Save(const map_request_t& request) {
  const auto save = map_.store().BeginSave(request.path);
  if (!save) return tl::unexpected(save.error());
  const auto was_saved = std::make_shared<bool>(false);
  return Reading{[this, save = *save, was_saved](const MapSnapshot& map) -> Result<Answer> {
                   const Result<std::string> saved = map_.store().SaveCopy(save, map);
                   *was_saved = saved.has_value();
                   if (!saved) return tl::unexpected(saved.error());
                   return Answer{*saved};
                 },
                 [this, save = *save, was_saved](const MapSnapshot& map) {
                   map_.store().EndSave(save, map, *was_saved, map_.session());
                 }};
}

Result<MapRequests::Reading> MapRequests::ReadObjects(const map_request_t& request) {
  const Result<ObjectQuery> query = QueryOf(request);
  if (!query) return tl::unexpected(query.error());
  const auto objects = std::make_shared<std::optional<std::vector<ObjectSummary>>>();
  return Reading{[options = options_, query = *query, objects](const MapSnapshot& map) {
                   MapProducts products = MakeProducts(map.map, map.metadata, options);
                   Result<Answer> answer = AnswerObjects(map, query, products.up, products.objects);
                   *objects = std::move(products.objects);
                   return answer;
                 },
                 [this, objects](const MapSnapshot& map) {
                   if (!*objects) return;
                   map_.publisher().objects().PublishLate(map_.session(), map,
                                                          std::move(**objects));
                 }};
}

Result<MapRequests::Reading> MapRequests::ReadMesh(const map_request_t& request) {
  if (request.argument.find('=') != std::string::npos) return ReadSurface(request, false);
  if (request.argument == "ply")
    return Reading{[options = options_](const MapSnapshot& map) -> Result<Answer> {
      return AnswerMeshFile(map, options);
    }};
  if (request.argument != "digest") return ReadMeshGap(request);
  map_.publisher().PublishMesh(map_.session());
  return Reading{[meshing = options_.meshing](const MapSnapshot& map) -> Result<Answer> {
    return Answer{MeshPublisher::DigestOf(map.map, meshing)};
  }};
}

// What a follower of MESH_DELTA lacks.
Result<MapRequests::Reading> MapRequests::ReadMeshGap(const map_request_t& request) {
  const Result<FollowerPosition> position = ParseFollowerPosition(request.argument);
  if (!position)
    return Fail("argument of mesh: ply, digest, id=7 or class=NAME for objects, or a " +
                position.error().message);
  MeshPublisher& publisher = map_.publisher().mesh();
  MeshGap gap = publisher.GapSince(map_.session().map(), *position);
  const int64_t revision = gap.revision;
  return Reading{[this, &publisher, gap = std::move(gap),
                  meshing = options_.meshing](const MapSnapshot& map) -> Result<Answer> {
                   MeshPublisher::MakeMessages(
                       gap, map.map, map.metadata.map_id, meshing, [&](mesh_delta_t message) {
                         while (!bus_.WaitForRoom(0.1) && !bus_.stop_requested()) {
                         }
                         worker_.Post([&publisher, message = std::move(message)]() mutable {
                           publisher.Send(std::move(message));
                         });
                       });
                   return Answer{"published on " + std::string(kMeshDeltaChannel.name)};
                 },
                 // What was published meanwhile builds on a revision that the follower lacked.
                 [this, &publisher, revision](const MapSnapshot& map) {
                   publisher.PublishNewer(map_.session().map(), {map.metadata.map_id, revision});
                 }};
}

Result<MapRequests::Reading> MapRequests::ReadPoints(const map_request_t& request) {
  return ReadSurface(request, true);
}

// Objects are those that were published last, from which clients know their ids.
Result<MapRequests::Reading> MapRequests::ReadSurface(const map_request_t& request,
                                                      bool points_only) {
  const Result<ObjectQuery> query = QueryOf(request);
  if (!query) return tl::unexpected(query.error());
  if (Objects().empty()) {
    return Reading{[query = *query, options = options_, points_only](const MapSnapshot& map) {
      return AnswerUnknownSurface(map, query, options, points_only);
    }};
  }
  auto selected = SelectObjects(Objects(), *query);
  if (!selected) return tl::unexpected(selected.error());
  std::vector<BlockIndex> places = PlacesOf(*selected, map_.session().map().labels, Places());
  return Reading{[objects = std::move(*selected), places = std::move(places),
                  meshing = options_.meshing, points_only](const MapSnapshot& map) {
    return AnswerSurface(map, objects, places, meshing, points_only);
  }};
}

Result<MapRequests::EditedCopy> MapRequests::SpaceWithout(const std::string& without) {
  if (Objects().empty()) {
    return EditedCopy([without, options = options_](const MapSnapshot& map) {
      return EditSpace(map.map, map.metadata, without, options);
    });
  }
  auto edits = ReadEdits(
      map_.session().map(), Objects(), [&](SegmentLabel label) { return Places().BlocksOf(label); },
      without);
  if (!edits) return tl::unexpected(edits.error());
  return EditedCopy([edits = std::move(*edits), free_space = options_.free_space](
                        const MapSnapshot& map) { return EditSpace(map.map, edits, free_space); });
}

Result<MapRequests::Reading> MapRequests::ReadOctree(const map_request_t& request) {
  if (request.without.empty()) {
    return Reading{[request, options = options_](const MapSnapshot& map) {
      return AnswerMapOctree(map.map, map.metadata, request, options);
    }};
  }
  const Result<EditedCopy> edited = SpaceWithout(request.without);
  if (!edited) return tl::unexpected(edited.error());
  return Reading{
      [request, options = options_, edited = *edited](const MapSnapshot& map) -> Result<Answer> {
        const Result<EditedSpace> space = edited(map);
        if (!space) return tl::unexpected(space.error());
        return AnswerMapOctree(map.map, map.metadata, request, options, &space->delta);
      }};
}

Result<MapRequests::Reading> MapRequests::ReadOccupancy(const map_request_t& request) {
  const Result<EditedCopy> edited = SpaceWithout(request.without);
  if (!edited) return tl::unexpected(edited.error());
  return Reading{[edited = *edited](const MapSnapshot& map) -> Result<Answer> {
    const Result<EditedSpace> space = edited(map);
    if (!space) return tl::unexpected(space.error());
    return AnswerOccupancy(*space);
  }};
}

// What a follower of MAP_DELTA lacks.
Result<MapRequests::Reading> MapRequests::ReadSpaceGap(const map_request_t& request) {
  const Result<FollowerPosition> position = ParseFollowerPosition(request.argument);
  if (!position) return Fail("argument of snapshot: " + position.error().message);
  OccupancyPublisher& publisher = map_.publisher().occupancy();
  const auto messages = std::make_shared<std::vector<map_delta_t>>();
  return Reading{
      [gap = publisher.GapSince(*position), digest = publisher.Digest(),
       free_space = options_.free_space, messages](const MapSnapshot& map) -> Result<Answer> {
        *messages = OccupancyPublisher::MessagesFor(gap, map.map, free_space);
        return Answer{digest};
      },
      // Frames that were published meanwhile build on a revision that the follower lacked.
      [this, &publisher, messages](const MapSnapshot& map) {
        publisher.Send(std::move(*messages));
        publisher.PublishNewer(map_.session().map(), map.position());
      }};
}

Result<MapRequests::Reading> MapRequests::ReadStatistics(const map_request_t&) {
  return Reading{[digest = map_.publisher().occupancy().Digest(),
                  memory = map_.Memory()](const MapSnapshot& map) -> Result<Answer> {
    return AnswerStatistics(map, digest, memory);
  }};
}

Result<MapRequests::Reading> MapRequests::ReadMap(const map_request_t&) {
  return Reading{[](const MapSnapshot& map) -> Result<Answer> { return AnswerMapFile(map); }};
}

Result<MapRequests::Reading> MapRequests::ReadFrames(const map_request_t& request) {
  return Reading{[argument = request.argument](const MapSnapshot& map) {
    return AnswerFrames(map, argument);
  }};
}

Result<MapRequests::Reading> MapRequests::ReadCell(const map_request_t& request) {
  return Reading{[free_space = options_.free_space, argument = request.argument](
                     const MapSnapshot& map) { return AnswerCell(map, free_space, argument); }};
}

}  // namespace vismap
