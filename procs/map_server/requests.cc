#include <map>
#include <nlohmann/json.hpp>

#include "base/class_names.h"
#include "exports/objects_json.h"
#include "exports/ply.h"
#include "exports/statistics.h"
#include "map_server/map_server.h"
#include "objects/object_query.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "wire/octree_message.h"

// What the map server does when somebody asks it on MAP_REQUEST.

namespace vismap {
namespace {

constexpr size_t kRememberedReplies = 64;

std::vector<uint8_t> Bytes(const std::string& text) { return {text.begin(), text.end()}; }

}  // namespace

void MapServer::OnRequest(const map_request_t& request) {
  for (const map_reply_t& reply : recent_replies_) {
    if (reply.requester == request.source && reply.request_id == request.request_id) {
      bus_->Publish(kMapReplyChannel, reply);
      return;
    }
  }
  if (request.verb.starts_with("octomap")) return;  // the octomap exporter's
  if (!request.map_id.empty() && request.map_id != map_id()) return;
  const Result<Answer> answer = Answered(request);
  map_reply_t reply{};
  reply.utime = WallUtime();
  reply.requester = request.source;
  reply.request_id = request.request_id;
  reply.ok = answer.has_value();
  reply.message = answer ? answer->message : answer.error().message;
  reply.map_id = map_id();
  reply.revision = map().revision;
  if (answer) {
    reply.encoding = answer->encoding;
    reply.payload = answer->payload;
    reply.payload_size = static_cast<int32_t>(reply.payload.size());
  }
  status_->Count(reply.ok ? "requests_done" : "requests_refused");
  if (!reply.ok)
    LogWarning("request '" + request.verb + "' of " + request.source + ": " + reply.message);
  bus_->Publish(kMapReplyChannel, reply);
  if (reply.payload_size < static_cast<int32_t>(kMegabyte))
    recent_replies_.push_back(std::move(reply));
  if (recent_replies_.size() > kRememberedReplies) recent_replies_.pop_front();
}

Result<MapServer::Answer> MapServer::Answered(const map_request_t& request) {
  static const std::map<std::string, Handler> kHandlers{
      {"save", &MapServer::AnswerSave},
      {"load", &MapServer::AnswerLoad},
      {"reset", &MapServer::AnswerReset},
      {"objects", &MapServer::AnswerObjects},
      {"mesh", &MapServer::AnswerMesh},
      {"octree", &MapServer::AnswerOctree},
      {"statistics", &MapServer::AnswerStatistics},
      {"snapshot", &MapServer::AnswerSnapshot},
      {"frames", &MapServer::AnswerFrames}};
  const auto handler = kHandlers.find(request.verb);
  if (handler == kHandlers.end()) {
    return Fail(
        "unknown request '" + request.verb +
        "'; known are frames, load, mesh, objects, octree, reset, save, snapshot, statistics");
  }
  return (this->*handler->second)(request);
}

Result<MapServer::Answer> MapServer::AnswerSave(const map_request_t& request) {
  const Result<std::string> saved = Save(request.path);
  if (!saved) return tl::unexpected(saved.error());
  return Answer{*saved, "", {}};
}

Result<MapServer::Answer> MapServer::AnswerLoad(const map_request_t& request) {
  const Result<std::string> loaded = Load(request.path);
  if (!loaded) return tl::unexpected(loaded.error());
  PublishAll();
  return Answer{*loaded, "", {}};
}

Result<MapServer::Answer> MapServer::AnswerReset(const map_request_t&) {
  StartMap(MapSession(session_options_, NewMetadata()));
  PublishAll();
  return Answer{"the map is empty now; it is map " + map_id(), "", {}};
}

Result<MapServer::Answer> MapServer::AnswerObjects(const map_request_t& request) {
  Result<ObjectQuery> query = ParseObjectQuery(request.argument);
  if (!query) return tl::unexpected(query.error());
  if (request.has_bbx) {
    query->region_W =
        Eigen::AlignedBox3d(Eigen::Vector3d(request.bbx_min_W), Eigen::Vector3d(request.bbx_max_W));
  }
  const Result<std::vector<ObjectSummary>> objects =
      SelectObjects(PublishObjects(AllObjects()), *query);
  if (!objects) return tl::unexpected(objects.error());
  return Answer{std::to_string(objects->size()) + " objects and segments", "json",
                Bytes(ObjectsJson(map_id(), *objects, ClassName))};
}

Result<MapServer::Answer> MapServer::AnswerMesh(const map_request_t& request) {
  if (request.argument == "ply") {
    const MapProducts products = MakeProducts(map(), session_->metadata(), outputs_);
    return Answer{std::to_string(products.mesh.triangles.size()) + " triangles", "ply",
                  EncodePly(products.mesh, {map_id(), {}})};
  }
  if (request.argument == "digest") {
    PublishMesh();
    return Answer{MeshPublisher::DigestOf(map(), outputs_.meshing), "", {}};
  }
  const Result<FollowerPosition> position = ParseFollowerPosition(request.argument);
  if (!position) return Fail("argument of mesh: ply, digest, or a " + position.error().message);
  mesh_.PublishSince(map(), *position);
  return Answer{"published on " + std::string(kMeshDeltaChannel.name), "", {}};
}

Result<MapServer::Answer> MapServer::AnswerOctree(const map_request_t& request) {
  OctreeOptions options = config_.octree;
  if (request.resolution_m > 0) options.resolution_m = request.resolution_m;
  options.unknown = request.unknown == map_request_t::UNKNOWN_OCCUPIED ? UnknownPolicy::kOccupied
                                                                       : UnknownPolicy::kAbsent;
  if (request.has_bbx) {
    options.bounds_W =
        Eigen::AlignedBox3d(Eigen::Vector3d(request.bbx_min_W), Eigen::Vector3d(request.bbx_max_W));
  }
  Result<OctreeBytes> octree = BuildOctree(ClassifyMap(map(), outputs_.free_space), options);
  if (!octree) return tl::unexpected(octree.error());
  return Answer{std::to_string(octree->nodes) + " nodes", "bt", std::move(octree->bytes)};
}

Result<MapServer::Answer> MapServer::AnswerStatistics(const map_request_t&) {
  auto json = nlohmann::ordered_json::parse(StatisticsJson(map(), session_->metadata()));
  json["occupancy_digest"] = occupancy_.Digest();
  return Answer{json["hash"].get<std::string>(), "json", Bytes(json.dump())};
}

Result<MapServer::Answer> MapServer::AnswerSnapshot(const map_request_t& request) {
  const Result<FollowerPosition> position = ParseFollowerPosition(request.argument);
  if (!position) return Fail("argument of snapshot: " + position.error().message);
  occupancy_.PublishSince(map(), *position);
  return Answer{occupancy_.Digest(), "", {}};
}

Result<MapServer::Answer> MapServer::AnswerFrames(const map_request_t&) {
  auto frames = nlohmann::json::array();
  for (const CameraPose& pose : session_->metadata().trajectory)
    frames.push_back({Raw(pose.camera_id), pose.utime});
  return Answer{std::to_string(frames.size()) + " frames", "json", Bytes(frames.dump())};
}

}  // namespace vismap
