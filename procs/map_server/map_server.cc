#include "map_server/map_server.h"

#include <algorithm>
#include <filesystem>

#include "base/class_names.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/version.h"
#include "session/map_frame.h"
#include "settings/settings.h"
#include "wire/object_list.h"
#include "wire/segmented_frame.h"

namespace vismap {
namespace {

constexpr size_t kMaxSkipped = 100000;
constexpr double kObjectsRepeat = 5.0;  // [s]

}  // namespace

MapServer::MapServer(const VismapConfig& config, Bus* bus, Status* status)
    : config_(config),
      session_options_(SessionOptionsOf(config)),
      outputs_(OutputOptionsOf(config)),
      bus_(bus),
      status_(status),
      occupancy_(outputs_.occupancy, bus),
      mesh_(outputs_.meshing, bus) {
  StartMap(MapSession(session_options_, NewMetadata()));
  bus_->Subscribe<segmented_frame_t>(
      kSegmentedFrameChannel,
      [this](const segmented_frame_t& message) { return OnFrame(message); });
  bus_->Every(0.5, [this] {
    PublishNowAndThen();
    Repeat();
  });
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
  occupancy_.Start(map(), map_id());
  mesh_.Start(map(), map_id());
  tracker_.Clear();
  order_.Clear();
  skipped_.clear();
}

Result<void> MapServer::OnFrame(const segmented_frame_t& message) {
  if (!order_.Add(KeyOf(message.frame), message.frame.after_utime, message)) {
    status_->Count("frames_not_held");
  }
  const auto committed = [this](const FrameKey& key) {
    return session_->Contains(key.camera_id, key.utime) || skipped_.contains(key);
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
  if (!frame) {
    Skip(message, frame.error().message);
    return tl::unexpected(frame.error());
  }
  status_->Set(ProcessState::kRunning, StatusMessage());
  bus_->Publish(kMapCommitChannel, TakeFrame(*frame, DigestInput(message)));
  PublishNowAndThen();
  return {};
}

// A frame that cannot be used is answered, too: nobody shall wait for it.
void MapServer::Skip(const segmented_frame_t& message, const std::string& reason) {
  const FrameKey key = KeyOf(message.frame);
  if (session_->Contains(key.camera_id, key.utime)) return;  // the good one came before
  if (skipped_.size() < kMaxSkipped) skipped_.insert(key);
  status_->Count("frames_skipped");
  frame_commit_t commit{};
  commit.utime = key.utime;
  commit.camera_id = Raw(key.camera_id);
  commit.frame_number = message.frame.frame_number;
  commit.map_id = map_id();
  commit.revision = map().revision;
  commit.status = frame_commit_t::STATUS_SKIPPED;
  commit.reason = reason;
  commit.had_detections = message.had_detections;
  commit.input_digest = DigestInput(message);
  bus_->Publish(kMapCommitChannel, commit);
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
  const Stopwatch watch{MonotonicSeconds, [this](const char* stage, double milliseconds) {
                          status_->AddTiming(stage, milliseconds);
                        }};
  const auto [association, delta] = MapFrame(frame, session_.get(), watch);
  status_->Count("frames_integrated");
  status_->Count("votes_evicted", delta.votes_evicted);
  if (frame.had_detections) status_->Count("frames_with_detections");
  commit.status = frame_commit_t::STATUS_INTEGRATED;
  commit.revision = map().revision;
  commit.digest = DigestFrame(map(), association, delta);
  NoteIntegrated({header.camera_id, header.utime});
  const StageTimer timer(status_, "publishing");
  occupancy_.PublishChanges(map(), delta.changed_blocks);
  mesh_.AddChanges(map(), delta);
  return commit;
}

void MapServer::NoteIntegrated(const FrameKey& frame) {
  if (const std::optional<std::string> remark = clocks_.Note(frame))
    LogWarningRateLimited("clock", *remark);
  status_->SetCounter("frames_out_of_order", clocks_.out_of_order());
  status_->SetCounter("clock_jumps", clocks_.jumps());
  if (!journal_.Add(frame)) {
    status_->Count("journal_errors");
    LogWarningRateLimited("journal", "cannot write the journal: is the disk full?");
  }
  if (lacking_.erase(frame) > 0) ShowLacking();
}

void MapServer::ShowLacking() {
  status_->SetCounter("frames_lacking", static_cast<int64_t>(lacking_.size()));
  status_->Set(status_->state(), StatusMessage());
}

std::string MapServer::StatusMessage() const {
  if (lacking_.empty()) return "";
  return "recovered after a crash; " + std::to_string(lacking_.size()) +
         " frames that the map had are lacking, sensors may send them again";
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
  if (mesh_.has_changes())
    publish(config_.map_server.mesh_period, &mesh_due_, [&] { PublishMesh(); });
  if (objects_revision_ != map().revision) {
    publish(config_.map_server.objects_period, &objects_due_, [&] { PublishObjectsNow(); });
  }
  if (config_.map_server.save_period > 0 && saved_revision_ != map().revision) {
    publish(config_.map_server.save_period, &save_due_, [&] { SaveNowAndThen(); });
  }
}

void MapServer::SaveNowAndThen() {
  const Result<std::string> saved = Save("");
  if (!saved) LogWarningRateLimited("save", saved.error().message);
}

void MapServer::PublishMesh() {
  const StageTimer timer(status_, "meshing");
  mesh_.PublishChanges(map());
}

// So that who missed the last message of a stream learns of it.
void MapServer::Repeat() {
  occupancy_.Heartbeat();
  mesh_.Heartbeat(map());
  if (objects_.map_id.empty() || MonotonicSeconds() < objects_repeat_due_) return;
  bus_->Publish(kObjectsChannel, objects_);
  objects_repeat_due_ = MonotonicSeconds() + kObjectsRepeat;
}

std::vector<ObjectSummary> MapServer::AllObjects() const {
  return MakeProducts(map(), session_->metadata(), outputs_).objects;
}

// While the map grows: what did not change is not looked at again.
void MapServer::PublishObjectsNow() {
  if (mesh_.has_changes()) PublishMesh();  // from which objects are read
  const StageTimer timer(status_, "objects");
  const auto places = [this](SegmentLabel label) {
    return mesh_.tracker().places().BlocksOf(label);
  };
  PublishObjects(tracker_.Summarize(map(), mesh_.tracker().surfaces(), places,
                                    ObjectOptionsFor(session_->metadata(), outputs_)));
}

std::vector<ObjectSummary> MapServer::PublishObjects(std::vector<ObjectSummary> objects) {
  ObjectList list{map().last_utime, map_id(), map().revision, std::move(objects)};
  objects_ = Encode(list, ClassName);
  bus_->Publish(kObjectsChannel, objects_);
  objects_revision_ = map().revision;
  objects_repeat_due_ = MonotonicSeconds() + kObjectsRepeat;
  return std::move(list.objects);
}

void MapServer::PublishAll() {
  occupancy_.PublishSnapshot(map());
  mesh_.PublishAll(map());
  PublishObjects(AllObjects());
}

Result<std::string> MapServer::Save(const std::string& path) {
  const std::string& target = path.empty() ? config_.map_server.save_on_exit : path;
  if (target.empty())
    return Fail("no path given to save to, and none configured (map_server.save_on_exit)");
  const Result<SaveInfo> saved = SaveMap(map(), session_->metadata(), target);
  if (!saved) return tl::unexpected(saved.error());
  if (target == config_.map_server.save_on_exit) {
    saved_revision_ = map().revision;
    if (!journal_.Restart()) LogWarningRateLimited("journal", "cannot empty the journal");
  }
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

Result<std::string> MapServer::Recover() {
  const std::filesystem::path path = config_.map_server.save_on_exit;
  const std::filesystem::path journal = path.string() + ".journal";
  std::string told = "nothing to recover: there is no " + path.string();
  if (std::filesystem::exists(path)) {
    const Result<std::string> loaded = Load(path);
    if (!loaded) return loaded;
    told = *loaded;
  }
  const Result<std::vector<FrameKey>> committed = CommitJournal::Read(journal);
  if (!committed) return tl::unexpected(committed.error());
  for (const FrameKey& frame : *committed) {
    if (!session_->Contains(frame.camera_id, frame.utime)) lacking_.insert(frame);
  }
  ShowLacking();
  Result<CommitJournal> opened = CommitJournal::Open(journal);
  if (!opened) return tl::unexpected(opened.error());
  journal_ = std::move(*opened);
  return told + "; frames lacking that were committed later: " + std::to_string(lacking_.size());
}

}  // namespace vismap
