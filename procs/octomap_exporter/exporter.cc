#include "octomap_exporter/exporter.h"

#include <filesystem>

#include "base/file.h"
#include "base/format.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "wire/octree_message.h"

namespace vismap {

namespace {
constexpr double kRestAfterTooLarge = 60;  // before a map that was too large is asked for again [s]
}  // namespace

Exporter::Exporter(const VismapConfig& config, Bus* bus, Status* status)
    : config_(config),
      bus_(bus),
      status_(status),
      follower_({.max_bytes = static_cast<size_t>(config.octomap_exporter.max_map_mb) * kMegabyte}),
      catch_up_(bus, "snapshot"),
      export_pacer_(config.octomap_exporter.period_s),
      requests_(
          RequestReceiver::kOctomapExporter, [this] { return follower_.position(); }, bus, status) {
  bus_->Subscribe<map_delta_t>(kMapDeltaChannel,
                               [this](const map_delta_t& message) { return OnDelta(message); });
  HandleRequests();
  bus_->Every(0.2, [this] { OnTimer(); });
  for (const char* name : {"octree.bt", "octree.closed.bt"})
    RemoveStaleTemporaries(std::filesystem::path(config.octomap_exporter.output_folder) / name);
  catch_up_.Request(follower_.position());
}

Result<void> Exporter::OnDelta(const map_delta_t& message) {
  const StageTimer timer(status_, "following");
  Result<MapUpdate> update = Decode(message);
  if (!update) return tl::unexpected(update.error());
  const FollowOutcome outcome = follower_.Apply(std::move(*update), MonotonicSeconds());
  status_->SetCounter("updates_missed", follower_.gaps());
  status_->SetCounter("map_revision", follower_.position().revision);
  status_->SetCounter("map_bytes", static_cast<int64_t>(follower_.bytes()));
  if (outcome == FollowOutcome::kApplied) status_->Set(ProcessState::kRunning);
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
  octree_.reset();
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
  if (config_.octomap_exporter.period_s <= 0 || !has_news()) return;
  export_pacer_.RunIfDue([&] {
    const Result<std::string> exported = Export();
    std::optional<std::string> trouble;
    if (!exported) trouble = "there is no octree of the map: " + exported.error().message;
    status_->SetFinding("octree", trouble);
  });
}

Result<void> Exporter::UpdateOctree() {
  const OccupancyMap& map = *follower_.occupancy();
  const OccupancyChanges changes = follower_.ConsumeChanges();
  if (octree_ && !changes.everywhere) {
    octree_->Update(map, changes.blocks);
    return {};
  }
  octree_.reset();
  Result<OctreeBuilder> builder = OctreeBuilder::Make(map.cell_size(), config_.octree);
  if (!builder) return tl::unexpected(builder.error());
  octree_.emplace(std::move(*builder));
  octree_->Update(map, map.SortedIndices());
  return {};
}

Result<std::string> Exporter::Export() {
  if (!follower_.occupancy()) return Fail("no map yet: nothing has come on MAP_DELTA");
  const StageTimer timer(status_, "export");
  if (const Result<void> done = UpdateOctree(); !done) return tl::unexpected(done.error());
  OctreeMessage message{
      follower_.utime(),         follower_.position().map_id, follower_.position().revision,
      config_.grid.voxel_size_m, config_.free_space,          {}};
  message.voxel_size = follower_.occupancy()->cell_size();
  Result<OctreeBytes> octree = octree_->Build(config_.octomap_exporter.unknown);
  if (!octree) return tl::unexpected(octree.error());
  message.octree = std::move(*octree);
  TellLeftOut(message.octree.left_out);
  bus_->Publish(kOctomapChannel, Encode(message));
  status_->Count("octrees_published");
  exported_ = follower_.position();
  if (config_.octomap_exporter.output_folder.empty())
    return std::to_string(message.octree.nodes) + " nodes published";
  return WriteFiles();
}

void Exporter::TellLeftOut(const std::string& sentence) {
  status_->SetCounter("octree_incomplete", sentence.empty() ? 0 : 1);
  status_->SetFinding("octree", sentence.empty() ? std::nullopt : std::optional(sentence));
}

Result<std::string> Exporter::WriteFiles() {
  const std::filesystem::path folder =
      std::filesystem::absolute(config_.octomap_exporter.output_folder);
  for (const UnknownPolicy unknown : {UnknownPolicy::kAbsent, UnknownPolicy::kOccupied}) {
    const Result<OctreeBytes> tree = octree_->Build(unknown);
    if (!tree) return tl::unexpected(tree.error());
    const char* name = unknown == UnknownPolicy::kAbsent ? "octree.bt" : "octree.closed.bt";
    const Result<void> written = WriteOctree(folder / name, *tree);
    if (!written) return tl::unexpected(written.error());
  }
  return "revision " + std::to_string(exported_.revision) + " written to " + folder.string() +
         "/octree.bt and octree.closed.bt";
}

void Exporter::HandleRequests() {
  requests_.Handle("octomap", [this](const map_request_t&) -> Result<Answer> {
    const Result<std::string> exported = Export();
    if (!exported) return tl::unexpected(exported.error());
    return Answer{*exported};
  });
  requests_.Handle("octomap-digest", [this](const map_request_t&) -> Result<Answer> {
    if (!follower_.occupancy()) return Fail("no map yet");
    return Answer{follower_.occupancy()->Digest()};
  });
}

}  // namespace vismap
