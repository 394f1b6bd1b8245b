#include "octomap_exporter/exporter.h"

#include <cmath>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>
#include <vismap/object_list_t.hpp>
#include <vismap/process_status_t.hpp>

#include "base/file.h"
#include "base/format.h"
#include "navigation/overlay.h"
#include "requests/octree_request.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "wire/octree_message.h"

namespace vismap {

namespace {
constexpr double kRestAfterTooLarge = 60;  // before a map that was too large is asked for again [s]

constexpr double kPathPatience = 2;  // for positions of the camera [s]

constexpr const char* kOctreeFiles[] = {"octree.bt", "octree.closed.bt"};  // raw and closed

constexpr const char* kNothingKnown =
    "nothing is known yet: no space in the map is free or occupied, so no octree is published";
}  // namespace

Exporter::Exporter(const VismapConfig& config, Bus* bus, Status* status)
    : config_(config),
      bus_(bus),
      status_(status),
      follower_({.max_bytes = static_cast<size_t>(config.octomap_exporter.max_map_mb) * kMegabyte}),
      latched_(bus, config.octomap_exporter.repeat_mb_s * kMegabyte),
      leaf_deltas_(config.octree.shell_m, bus),
      distances_(config.octomap_exporter.distance_limit_m, bus),
      grid_(config, bus),
      path_(config.octomap_exporter.clear_start_m > 0 || config.octomap_exporter.grid_period_s > 0,
            config.octomap_exporter.clear_start_m > 0 ? kPathPatience : 0, bus),
      catch_up_(bus, "snapshot"),
      export_pacer_(config.octomap_exporter.period_s),
      requests_(
          RequestReceiver::kOctomapExporter, [this] { return follower_.position(); }, bus, status),
      space_without_(bus) {
  bus_->Subscribe<map_delta_t>(kMapDeltaChannel,
                               [this](const map_delta_t& message) { return OnDelta(message); });
  bus_->Subscribe<process_status_t>(kStatusChannel, [this](const process_status_t& message) {
    if (message.process == "map-server" && message.state != "stopping")
      server_heard_ = MonotonicSeconds();
  });
  bus_->Subscribe<object_list_t>(
      kObjectsChannel, [this](const object_list_t& message) { return up_.Hear(message); },
      Delivery::kLatest);
  HandleRequests();
  bus_->Every(0.2, [this] { OnTimer(); });
  bus_->Every(1.0, [this] { PublishNavigation(); });
  for (const char* name : kOctreeFiles)
    RemoveStaleTemporaries(std::filesystem::path(config.octomap_exporter.output_folder) / name);
  SetFilesAside();
  if (config.octomap_exporter.unknown == UnknownPolicy::kAbsent) {
    status_->SetFinding("policy",
                        "OCTOMAP carries a tree without unknown space (octomap_exporter.unknown: "
                        "ABSENT), which collision checkers take for free; remove that key from the "
                        "config, and read OCTOMAP_RAW where such a tree is wanted");
  }
  catch_up_.Request(follower_.position());
}

Result<void> Exporter::OnDelta(const map_delta_t& message) {
  const StageTimer timer(status_, "following");
  server_heard_ = MonotonicSeconds();
  Result<MapUpdate> update = Decode(message);
  if (!update) return tl::unexpected(update.error());
  const FollowOutcome outcome = follower_.Apply(std::move(*update), MonotonicSeconds());
  status_->SetCounter("updates_missed", follower_.gaps());
  status_->SetCounter("map_revision", follower_.position().revision);
  status_->SetCounter("map_bytes", static_cast<int64_t>(follower_.bytes()));
  if (outcome == FollowOutcome::kApplied) SetState();
  if (outcome == FollowOutcome::kTooLarge) return OnTooLarge();
  if (outcome == FollowOutcome::kNeedsSnapshot || outcome == FollowOutcome::kBroken) {
    if (MonotonicSeconds() >= next_catch_up_)
      status_->Set(ProcessState::kWaiting, "waiting for what was missed on MAP_DELTA");
    RequestCatchUp();
  }
  if (outcome == FollowOutcome::kBroken) {
    return Fail("update to revision " + std::to_string(message.revision) + " of map '" +
                message.map_id + "' does not fit the map; asking for a snapshot");
  }
  return {};
}

// Asking for the map again would only cost the map server work.
Result<void> Exporter::OnTooLarge() {
  const std::string sentence = "the map needs more than " +
                               std::to_string(config_.octomap_exporter.max_map_mb) +
                               " MB (octomap_exporter.max_map_mb), so it is not followed";
  ForgetTrees();
  SetFilesAside();
  export_error_ = sentence;
  next_catch_up_ = MonotonicSeconds() + kRestAfterTooLarge;
  status_->Count("updates_too_large");
  status_->Set(ProcessState::kWaiting, sentence);
  return Fail(sentence);
}

void Exporter::RequestCatchUp() {
  if (MonotonicSeconds() >= next_catch_up_) catch_up_.Request(follower_.position());
}

bool Exporter::has_news() const { return follower_.in_sync() && follower_.position() != exported_; }

void Exporter::OnTimer() {
  const size_t given_up = follower_.GiveUpStaleParts(MonotonicSeconds());
  status_->Count("parts_given_up", static_cast<int64_t>(given_up));
  if (given_up > 0) {
    LogWarningRateLimited("parts", FormatCount(static_cast<int64_t>(given_up), "part") +
                                       " of an update dropped: its other parts did not come");
  }
  if (!follower_.in_sync()) RequestCatchUp();
  ExportIfDue();
  PublishGrid();
  latched_.Repeat();
  grid_.Repeat();
  leaf_deltas_.Heartbeat();
  distances_.Heartbeat();
}

void Exporter::ExportIfDue() {
  if (config_.octomap_exporter.period_s <= 0 || !has_news()) return;
  path_.Request(follower_.position());
  if (path_.IsAwaited()) return;
  export_pacer_.RunIfDue([&] {
    const Result<std::string> exported = Export();
    export_error_ = exported ? "" : "there is no octree of the map: " + exported.error().message;
    if (!exported) status_->SetFinding("octree", export_error_);
    SetState();
  });
}

std::string Exporter::Trouble() const {
  if (!export_error_.empty()) return export_error_;
  if (!follower_.occupancy()) return "nothing is known yet: no map has come on MAP_DELTA";
  if (!follower_.in_sync()) return "updates of the map are missing, and were asked for";
  return follower_.occupancy()->size() == 0 || (trees_ && trees_->is_empty()) ? kNothingKnown : "";
}

void Exporter::SetState() {
  const std::string trouble = Trouble();
  status_->Set(trouble.empty() ? ProcessState::kRunning : ProcessState::kWaiting, trouble);
}

Result<void> Exporter::BringUpToDate() {
  if (trees_ && updated_ == follower_.position()) return {};
  return UpdateTrees();
}

// Updates trees and distances, and tells followers what changed.
Result<void> Exporter::UpdateTrees() {
  const OccupancyMap& map = *follower_.occupancy();
  const OccupancyChanges changes = follower_.ConsumeChanges();
  const bool anew = changes.everywhere || !trees_;
  if (anew) {
    ForgetTrees();
    Result<TreeSet> trees = TreeSet::Make(map.cell_size(), config_);
    if (!trees) return tl::unexpected(trees.error());
    trees_.emplace(std::move(*trees));
  }
  updated_ = follower_.position();
  FollowPath(anew);
  OccupancyDelta leaves = trees_->Update(map, anew ? map.SortedIndices() : changes.blocks);
  status_->SetCounter("assumed_free_leaves", static_cast<int64_t>(trees_->assumed_free()));
  std::vector<BlockIndex> changed;
  for (const auto& entry : leaves.blocks) changed.push_back(entry.first);
  const Result<void> distances =
      distances_.Update(updated_, follower_.utime(), trees_->leaves(), changed);
  if (!distances) {
    ForgetTrees();
    return distances;
  }
  leaf_deltas_.PublishChanges(follower_.position(), follower_.utime(), map.cell_size(),
                              std::move(leaves));
  return {};
}

// Followers of OCTOMAP_DELTA have one state for each revision, so that new positions count only
// together with a new revision.
void Exporter::FollowPath(bool anew) {
  if (anew) path_used_ = 0;
  const std::vector<Eigen::Vector3d>& path_W = path_.positions_W();
  if (path_.map_id() != updated_.map_id || path_used_ >= path_W.size()) return;
  const Result<void> added = trees_->AddPath(std::span(path_W).subspan(path_used_));
  path_used_ = path_W.size();
  status_->SetFinding("path", added ? std::nullopt : std::optional(added.error().message));
}

// The trees of a map that is gone are neither repeated nor continued.
void Exporter::ForgetTrees() {
  trees_.reset();
  latched_.Clear();
  leaf_deltas_.Clear();
  distances_.Clear();
  grid_.Clear();
}

Result<std::string> Exporter::Export() {
  if (!follower_.occupancy()) return Fail("no map yet: nothing has come on MAP_DELTA");
  const StageTimer timer(status_, "export");
  if (const Result<void> done = BringUpToDate(); !done) return tl::unexpected(done.error());
  exported_ = follower_.position();
  if (trees_->is_empty()) {
    latched_.Clear();
    SetFilesAside();
    TellLeftOut("");
    return kNothingKnown;
  }
  Result<std::string> published = Publish();
  if (!published || config_.octomap_exporter.output_folder.empty()) return published;
  return WriteFiles();
}

Result<std::string> Exporter::Publish() {
  Result<std::vector<PublishedTree>> trees = trees_->Build();
  if (!trees) return tl::unexpected(trees.error());
  TellLeftOut(trees->front().octree.left_out);
  const int64_t nodes = trees->front().octree.nodes;
  for (PublishedTree& tree : *trees) {
    OctreeMessage message;
    message.utime = follower_.utime();
    message.map_id = follower_.position().map_id;
    message.revision = follower_.position().revision;
    message.voxel_size = follower_.occupancy()->cell_size();
    message.rule = config_.free_space;
    message.octree = std::move(tree.octree);
    message.inflated_by = tree.inflated_by;
    message.assumed_free = std::move(tree.assumed_free);
    latched_.Publish(tree.channel, Encode(message));
  }
  status_->Count("octrees_published");
  return std::to_string(nodes) + " nodes published";
}

void Exporter::TellLeftOut(const std::string& sentence) {
  status_->SetCounter("octree_incomplete", sentence.empty() ? 0 : 1);
  status_->SetFinding("octree", sentence.empty() ? std::nullopt : std::optional(sentence));
}

Result<std::string> Exporter::WriteFiles() {
  const std::filesystem::path folder =
      std::filesystem::absolute(config_.octomap_exporter.output_folder);
  for (const UnknownPolicy unknown : {UnknownPolicy::kAbsent, UnknownPolicy::kOccupied}) {
    const Result<OctreeBytes> tree = trees_->Build(unknown);
    if (!tree) return tl::unexpected(tree.error());
    const char* name = kOctreeFiles[static_cast<size_t>(unknown)];
    const Result<void> written = WriteOctree(folder / name, *tree);
    if (!written) return tl::unexpected(written.error());
  }
  return "revision " + std::to_string(exported_.revision) + " written to " + folder.string() +
         "/octree.bt and octree.closed.bt";
}

// Files of an earlier run, or of a map that is gone, are not those of the present map.
void Exporter::SetFilesAside() {
  const std::string& folder = config_.octomap_exporter.output_folder;
  if (folder.empty()) return;
  for (const char* name : kOctreeFiles) {
    const Result<void> done = SetOctreeAside(std::filesystem::absolute(folder) / name);
    if (!done) LogWarningRateLimited(name, done.error().message);
  }
}

void Exporter::HandleRequests() {
  requests_.HandleLate("octomap",
                       [this](const map_request_t& request, const RequestServer::Reply& reply) {
                         BeginOctomap(request, reply);
                       });
  requests_.Handle("octomap-delta",
                   [this](const map_request_t& request) { return AnswerDelta(request); });
  requests_.Handle("octomap-digest", [this](const map_request_t&) -> Result<Answer> {
    if (!follower_.occupancy()) return Fail("no map yet");
    return Answer{follower_.occupancy()->Digest()};
  });
  requests_.Handle("distances-delta", [this](const map_request_t& request) -> Result<Answer> {
    const Result<FollowerPosition> position = ParseFollowerPosition(request.argument);
    if (!position) return Fail("argument of distances-delta: " + position.error().message);
    const Result<void> published = distances_.PublishSince(*position);
    if (!published) return tl::unexpected(published.error());
    return Answer{"published on " + std::string(kDistancesChannel.name)};
  });
  const std::pair<const char*, Question> questions[] = {{"grid", AnswerGrid},
                                                        {"distances", AnswerDistances},
                                                        {"clearance", AnswerClearance},
                                                        {"frontiers", AnswerFrontiers}};
  for (const auto& [verb, ask] : questions) {
    requests_.HandleLate(
        verb, [this, ask](const map_request_t& request, const RequestServer::Reply& reply) {
          BeginQuestion(request, ask, reply);
        });
  }
}

void Exporter::BeginQuestion(const map_request_t& request, Question ask,
                             const RequestServer::Reply& reply) {
  if (!follower_.occupancy()) return reply(Fail("no map yet: nothing has come on MAP_DELTA"));
  if (const Result<void> done = BringUpToDate(); !done) return reply(tl::unexpected(done.error()));
  const auto problem = up_.GridProblem(follower_.position().map_id);
  if (problem && ask == AnswerGrid) return reply(Fail(*problem));
  WithSpace(request, std::nullopt, reply, [this, request, ask](const OccupancyMap& voxels) {
    NavigationSpace space = Space();
    if (request.without.empty()) return ask(space, request);
    space.voxels = &voxels;
    space.leaves = nullptr;
    space.field = nullptr;
    space.is_edited = true;
    return ask(space, request);
  });
}

NavigationSpace Exporter::Space() const {
  NavigationSpace space;
  space.voxels = &*follower_.occupancy();
  if (trees_) space.leaves = &trees_->leaves();
  space.field = distances_.field();
  space.map_id = follower_.position().map_id;
  space.revision = follower_.position().revision;
  space.utime = follower_.utime();
  space.octree = config_.octree;
  space.grid = config_.ground_grid;
  if (space.field != nullptr) space.distance_limit_m = space.field->limit_m();
  space.path_W = path_.positions_W();
  space.robot_radius_m = config_.octomap_exporter.robot_radius_m;
  return space;
}

void Exporter::PublishGrid() {
  const FollowerPosition& position = follower_.position();
  if (config_.octomap_exporter.grid_period_s <= 0 || !follower_.in_sync() || !follower_.occupancy())
    return;
  if (const auto problem = up_.GridProblem(position.map_id)) {
    grid_.Clear();
    return TellOfGrid(problem);
  }
  if (!grid_.IsDue(position)) return;
  path_.Request(position);
  const StageTimer timer(status_, "grid");
  const Result<void> published =
      grid_.Publish(*follower_.occupancy(), position, follower_.utime(), path_.positions_W());
  TellOfGrid(published ? std::nullopt : std::optional(published.error().message));
}

void Exporter::TellOfGrid(const std::optional<std::string>& problem) {
  status_->SetFinding("grid", problem);
  grid_error_ = problem.value_or("");
}

void Exporter::WithSpace(const map_request_t& request, const std::optional<BlockRegion>& region,
                         const RequestServer::Reply& reply, AnswerFromSpace answer) {
  if (!follower_.occupancy()) return reply(Fail("no map yet: nothing has come on MAP_DELTA"));
  if (request.without.empty()) return reply(answer(*follower_.occupancy()));
  const std::string map_id = follower_.position().map_id;
  space_without_.Ask(map_id, request.without,
                     [=, this](const Result<OccupancyDelta>& blocks) -> void {
                       if (!blocks) return reply(tl::unexpected(blocks.error()));
                       if (!follower_.occupancy() || follower_.position().map_id != map_id)
                         return reply(Fail("another map has taken the place of " + map_id));
                       const auto space = OccupancyWith(*follower_.occupancy(), *blocks, region);
                       if (!space) return reply(tl::unexpected(space.error()));
                       reply(answer(*space));
                     });
}

// A request that restricts nothing also publishes the trees, when the map has changed.
void Exporter::BeginOctomap(const map_request_t& request, const RequestServer::Reply& reply) {
  if (!follower_.occupancy()) return reply(Fail("no map yet: nothing has come on MAP_DELTA"));
  const double voxel_size = follower_.occupancy()->cell_size();
  const auto read = ReadOctreeRequest(request, voxel_size, config_.octree);
  if (!read) return reply(tl::unexpected(read.error()));
  std::string written;
  if (!request.has_bbx && request.without.empty() && has_news()) {
    const Result<std::string> exported = Export();
    if (!exported) return reply(tl::unexpected(exported.error()));
    written = "; " + *exported;
  }
  WithSpace(request, read->Region(voxel_size * kBlockSide), reply,
            [this, read = *read, written](const OccupancyMap& space) {
              Result<Answer> answer = AnswerOctree(space, read, follower_.utime());
              if (answer) answer->message += written;
              return answer;
            });
}

Result<Answer> Exporter::AnswerDelta(const map_request_t& request) {
  const Result<FollowerPosition> position = ParseFollowerPosition(request.argument);
  if (!position) return Fail("argument of octomap-delta: " + position.error().message);
  if (!trees_) return Fail("no octree yet: nothing has come on MAP_DELTA");
  leaf_deltas_.PublishSince(*position, trees_->leaves());
  return Answer{"published on " + std::string(kOctomapDeltaChannel.name)};
}

void Exporter::PublishNavigation() {
  navigation_status_t message{};
  message.utime = follower_.utime();
  message.published_utime = WallUtime();
  message.map_id = follower_.position().map_id;
  message.revision = follower_.position().revision;
  message.in_sync = follower_.in_sync();
  // The wall clock may have been set since the map server was heard.
  if (server_heard_)
    message.server_utime =
        message.published_utime - std::llround((MonotonicSeconds() - *server_heard_) * 1e6);
  message.message = Trouble();
  message.n_assumed_free = trees_ ? static_cast<int32_t>(trees_->assumed_free()) : 0;
  const auto add = [&](const Channel& channel, int64_t revision, int64_t utime, int64_t published) {
    message.channels.emplace_back(channel.name);
    message.revisions.push_back(revision);
    message.utimes.push_back(utime);
    message.published_utimes.push_back(published);
  };
  for (const LatchedTrees::Sent& sent : latched_.sent())
    add(sent.channel, sent.tree.revision, sent.tree.utime, sent.tree.published_utime);
  if (const auto& grid = grid_.sent())
    add(kGridChannel, grid->revision, grid->utime, grid->published_utime);
  if (!grid_error_.empty()) {
    add(kGridChannel, -1, 0, 0);
    if (message.message.empty())
      message.message = std::string(kGridChannel.name) + ": " + grid_error_;
  }
  if (distances_.field() != nullptr) {
    add(kDistancesChannel, distances_.position().revision, distances_.utime(),
        distances_.published_utime());
  }
  message.n_outputs = static_cast<int32_t>(message.channels.size());
  bus_->Publish(kNavigationChannel, message);
}

}  // namespace vismap
