#include "map_server/map_server.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "datasets/class_names.h"
#include "meshing/ply.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/version.h"
#include "session/statistics.h"
#include "settings/settings.h"
#include "wire/map_update.h"
#include "wire/mesh_update.h"
#include "wire/object_list.h"
#include "wire/octree_message.h"
#include "wire/segmented_frame.h"

namespace vismap {
namespace {

constexpr size_t kBlocksPerDelta = 8192;  // at most a few hundred kilobytes compressed
constexpr size_t kBlocksPerMesh = 256;    // a few megabytes
constexpr size_t kRememberedReplies = 64;

std::vector<uint8_t> Bytes(const std::string& text) { return {text.begin(), text.end()}; }

}  // namespace

MapServer::MapServer(const VismapConfig& config, Bus* bus, Status* status)
    : config_(config),
      session_options_(SessionOptionsOf(config)),
      outputs_(OutputOptionsOf(config)),
      bus_(bus),
      status_(status),
      occupancy_(config.grid.voxel_size) {
  StartMap(MapSession(session_options_, NewMetadata()));
  bus_->Subscribe<segmented_frame_t>(
      kSegmentedFrameChannel,
      [this](const segmented_frame_t& message) { return OnFrame(message); });
  bus_->Every(0.5, [this] { PublishNowAndThen(); });
  bus_->Subscribe<map_request_t>(kMapRequestChannel,
                                 [this](const map_request_t& request) { OnRequest(request); });
}

MapMetadata MapServer::NewMetadata() const {
  MapMetadata metadata;
  metadata.map_id = bus_->source() + "-" + std::to_string(WallUtime());
  metadata.config = PrintConfig(config_);
  metadata.created_by = std::string("vismap-map-server ") + Version();
  return metadata;
}

void MapServer::StartMap(MapSession session) {
  session_ = std::make_unique<MapSession>(std::move(session));
  occupancy_ = OccupancyMap(config_.grid.voxel_size);
  const std::vector<BlockIndex> all = map().voxels.SortedIndices();
  occupancy_.Update(map(), all, outputs_.occupancy);
  mesh_dirty_ = all;
  mesh_revision_ = -1;
  order_.Clear();
}

Result<void> MapServer::OnFrame(const segmented_frame_t& message) {
  if (!order_.Add(KeyOf(message.frame), message.frame.after_utime, message)) {
    status_->Count("frames_not_held");
  }
  const auto committed = [this](const FrameKey& key) {
    return session_->Contains(key.camera_id, key.utime);
  };
  Result<void> taken;
  while (const std::optional<segmented_frame_t> next = order_.Next(committed)) {
    if (const Result<void> one = TakeMessage(*next); !one) taken = one;
  }
  status_->SetCounter("frames_held", static_cast<int64_t>(order_.held()));
  return taken;
}

Result<void> MapServer::TakeMessage(const segmented_frame_t& message) {
  Result<SegmentedFrame> frame = [&] {
    const StageTimer timer(status_, "decoding");
    return Decode(message);
  }();
  if (!frame) return tl::unexpected(frame.error());
  status_->Set(ProcessState::kRunning);
  bus_->Publish(kMapCommitChannel, TakeFrame(*frame, DigestInput(message)));
  PublishNowAndThen();
  return {};
}

frame_commit_t MapServer::TakeFrame(const SegmentedFrame& frame, std::string input_digest) {
  const FrameHeader& header = frame.frame.header;
  frame_commit_t commit{};
  commit.utime = header.utime;
  commit.camera_id = Raw(header.camera_id);
  commit.frame_number = header.frame_number;
  commit.map_id = map_id();
  commit.had_detections = frame.had_detections;
  commit.input_digest = std::move(input_digest);
  if (session_->Contains(header.camera_id, header.utime)) {
    status_->Count("frames_duplicate");
    commit.status = frame_commit_t::STATUS_DUPLICATE;
    commit.reason = "is in the map already";
    commit.revision = map().revision;
    return commit;
  }
  FrameAssociation association;
  {
    const StageTimer timer(status_, "association");
    association = session_->Associate(frame);
  }
  MapDelta delta;
  {
    const StageTimer timer(status_, "integration");
    delta = session_->Integrate(frame, association);
  }
  status_->Count("frames_integrated");
  status_->Count("votes_evicted", delta.votes_evicted);
  if (frame.had_detections) status_->Count("frames_with_detections");
  commit.status = frame_commit_t::STATUS_INTEGRATED;
  commit.revision = map().revision;
  commit.digest = DigestFrame(map(), association, delta);
  const StageTimer timer(status_, "publishing");
  PublishDelta(delta.changed_blocks);
  mesh_dirty_.insert(mesh_dirty_.end(), delta.changed_blocks.begin(), delta.changed_blocks.end());
  return commit;
}

void MapServer::PublishDelta(const std::vector<BlockIndex>& changed) {
  MapUpdate update{map().last_utime, map_id(), map().revision, map().revision - 1, 0, 1, {}};
  update.delta = occupancy_.Update(map(), changed, outputs_.occupancy);
  for (const MapUpdate& part : SplitUpdate(std::move(update), kBlocksPerDelta)) {
    bus_->Publish(kMapDeltaChannel, Encode(part));
  }
}

// Products are published at most as often as configured, and never so often that they take more
// than a fifth of the time.
void MapServer::PublishNowAndThen() {
  const auto publish = [](double period, double* due, const auto& action) {
    const double start = MonotonicSeconds();
    if (start < *due) return;
    action();
    const double end = MonotonicSeconds();
    *due = end + std::max(period, 4 * (end - start));
  };
  if (!mesh_dirty_.empty())
    publish(config_.map_server.mesh_period, &mesh_due_, [&] { PublishMesh(false); });
  if (objects_revision_ != map().revision) {
    publish(config_.map_server.objects_period, &objects_due_, [&] { PublishObjects(); });
  }
  if (config_.map_server.save_period > 0 && saved_revision_ != map().revision) {
    publish(config_.map_server.save_period, &save_due_, [&] { SaveNowAndThen(); });
  }
}

void MapServer::SaveNowAndThen() {
  const Result<std::string> saved = Save("");
  if (!saved) LogWarningSometimes("save", saved.error().message);
}

void MapServer::PublishMesh(bool full) {
  const StageTimer timer(status_, "meshing");
  MeshUpdate update{map().last_utime,          map_id(), full ? -1 : mesh_revision_, full, 0, 1,
                    map().voxels.block_size(), {}};
  std::vector<BlockIndex> blocks = full ? map().voxels.SortedIndices() : std::move(mesh_dirty_);
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  update.mesh = MeshBlocks(map(), blocks, outputs_.meshing);
  mesh_dirty_.clear();
  mesh_revision_ = map().revision;
  for (const MeshUpdate& part : SplitUpdate(std::move(update), kBlocksPerMesh)) {
    bus_->Publish(kMeshDeltaChannel, Encode(part));
  }
}

std::vector<ObjectSummary> MapServer::PublishObjects() {
  const StageTimer timer(status_, "objects");
  MapProducts products = MakeProducts(map(), session_->metadata(), outputs_);
  ObjectList list{map().last_utime, map_id(), map().revision, std::move(products.objects)};
  bus_->Publish(kObjectsChannel, Encode(list, ClassName));
  objects_revision_ = map().revision;
  return std::move(list.objects);
}

void MapServer::PublishSnapshot() {
  MapUpdate update{map().last_utime, map_id(), map().revision, -1, 0, 1, occupancy_.Snapshot()};
  for (const MapUpdate& part : SplitUpdate(std::move(update), kBlocksPerDelta)) {
    bus_->Publish(kMapDeltaChannel, Encode(part));
  }
}

Result<std::string> MapServer::Save(const std::string& path) {
  const std::string& target = path.empty() ? config_.map_server.save_on_exit : path;
  if (target.empty())
    return Fail("no path given to save to, and none configured (map_server.save_on_exit)");
  const Result<SaveInfo> saved = SaveMap(map(), session_->metadata(), target);
  if (!saved) return tl::unexpected(saved.error());
  saved_revision_ = map().revision;
  return "saved " + std::to_string(saved->bytes) + " bytes to " + saved->path.string() +
         ", map hash " + saved->map_hash;
}

Result<std::string> MapServer::Load(const std::string& path) {
  if (path.empty()) return Fail("no path given to load from");
  Result<LoadedMap> loaded = LoadMap(path);
  if (!loaded) return tl::unexpected(loaded.error());
  loaded->metadata.map_id =
      NewMetadata()
          .map_id;  // consumers must not mix its revisions with those of the file's first life
  Result<MapSession> session = MapSession::Continue(session_options_, std::move(*loaded));
  if (!session) return Fail(path + ": " + session.error().message);
  StartMap(std::move(*session));
  return "loaded " + path + " with " + std::to_string(map().revision) + " frames as map " +
         map_id();
}

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
      {"snapshot", &MapServer::AnswerSnapshot}};
  const auto handler = kHandlers.find(request.verb);
  if (handler == kHandlers.end()) {
    return Fail("unknown request '" + request.verb +
                "'; known are load, mesh, objects, octree, reset, save, snapshot, statistics");
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
  PublishSnapshot();
  PublishMesh(true);
  PublishObjects();
  return Answer{*loaded, "", {}};
}

Result<MapServer::Answer> MapServer::AnswerReset(const map_request_t&) {
  StartMap(MapSession(session_options_, NewMetadata()));
  PublishSnapshot();
  PublishMesh(true);
  PublishObjects();
  return Answer{"the map is empty now; it is map " + map_id(), "", {}};
}

Result<MapServer::Answer> MapServer::AnswerObjects(const map_request_t&) {
  const std::vector<ObjectSummary> objects = PublishObjects();
  return Answer{std::to_string(objects.size()) + " objects and segments", "json",
                Bytes(ObjectsJson(map_id(), objects, ClassName))};
}

Result<MapServer::Answer> MapServer::AnswerMesh(const map_request_t& request) {
  if (request.argument == "ply") {
    const MapProducts products = MakeProducts(map(), session_->metadata(), outputs_);
    return Answer{std::to_string(products.mesh.triangles.size()) + " triangles", "ply",
                  EncodePly(products.mesh, {map_id(), {}})};
  }
  PublishMesh(true);
  return Answer{"published the whole mesh on " + std::string(kMeshDeltaChannel.name), "", {}};
}

Result<MapServer::Answer> MapServer::AnswerOctree(const map_request_t& request) {
  OctreeOptions options;
  options.resolution = request.resolution_m > 0 ? request.resolution_m : config_.octree.resolution;
  options.free_fraction = config_.octree.free_fraction;
  options.unknown = request.unknown == map_request_t::UNKNOWN_OCCUPIED ? UnknownPolicy::kOccupied
                                                                       : UnknownPolicy::kAbsent;
  if (request.has_bbx) {
    options.bounds_W =
        Eigen::AlignedBox3d(Eigen::Vector3d(request.bbx_min_W), Eigen::Vector3d(request.bbx_max_W));
  }
  Result<OctreeBytes> octree = BuildOctree(occupancy_, options);
  if (!octree) return tl::unexpected(octree.error());
  return Answer{std::to_string(octree->nodes) + " nodes", "bt", std::move(octree->bytes)};
}

Result<MapServer::Answer> MapServer::AnswerStatistics(const map_request_t&) {
  auto json = nlohmann::ordered_json::parse(StatisticsJson(map(), session_->metadata()));
  json["occupancy_digest"] = occupancy_.Digest();
  return Answer{json["hash"].get<std::string>(), "json", Bytes(json.dump())};
}

Result<MapServer::Answer> MapServer::AnswerSnapshot(const map_request_t&) {
  PublishSnapshot();
  return Answer{occupancy_.Digest(), "", {}};
}

}  // namespace vismap
