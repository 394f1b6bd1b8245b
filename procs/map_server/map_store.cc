#include "map_server/map_store.h"

#include <utility>

#include "mapfile/map_file.h"
#include "runtime/log.h"

namespace vismap {

MapStore::MapStore(std::filesystem::path path, double save_period_s, Status* status)
    : path_(std::move(path)),
      saves_periodically_(save_period_s > 0),
      save_pacer_(save_period_s),
      status_(status) {}

Result<MapSession> MapStore::Load(const std::string& path, const MapSessionOptions& options,
                                  std::string map_id) {
  if (path.empty()) return Fail("no path given to load from");
  Result<LoadedMap> loaded = LoadMap(path);
  if (!loaded) return tl::unexpected(loaded.error());
  loaded->metadata.map_id = std::move(map_id);
  Result<MapSession> session = MapSession::Continue(options, std::move(*loaded));
  if (!session) return Fail(path + ": " + session.error().message);
  return session;
}

Result<std::string> MapStore::Save(const MapSession& session, const std::string& path) {
  const std::filesystem::path target = path.empty() ? path_ : std::filesystem::path(path);
  if (target.empty())
    return Fail("no path given to save to, and none configured (map_server.save_on_exit)");
  const Result<SaveInfo> saved = SaveMap(session.map(), session.metadata(), target);
  if (!saved) return tl::unexpected(saved.error());
  if (target == path_) {
    saved_revision_ = session.map().revision;
    if (!journal_.Restart()) LogWarningRateLimited("journal", "cannot empty the journal");
  }
  return "saved " + std::to_string(saved->bytes) + " bytes to " + saved->path.string() +
         ", map hash " + saved->map_hash;
}

void MapStore::SaveIfDue(const MapSession& session) {
  if (!saves_periodically_ || saved_revision_ == session.map().revision) return;
  save_pacer_.RunIfDue([&] {
    const Result<std::string> saved = Save(session);
    if (!saved) LogWarningRateLimited("save", saved.error().message);
  });
}

Result<void> MapStore::StartJournal(const MapSession& session) {
  const std::filesystem::path journal = path_.string() + ".journal";
  const Result<std::vector<FrameKey>> integrated = CommitJournal::Read(journal);
  if (!integrated) return tl::unexpected(integrated.error());
  for (const FrameKey& frame : *integrated) {
    if (!session.Contains(frame.camera_id, frame.utime)) lacking_.insert(frame);
  }
  ShowLackingFrames();
  Result<CommitJournal> opened = CommitJournal::Open(journal);
  if (!opened) return tl::unexpected(opened.error());
  journal_ = std::move(*opened);
  return {};
}

void MapStore::AddFrame(const FrameKey& frame) {
  if (!journal_.Add(frame)) {
    status_->Count("journal_errors");
    LogWarningRateLimited("journal", "cannot write the journal: is the disk full?");
  }
  if (lacking_.erase(frame) > 0) ShowLackingFrames();
}

void MapStore::ShowLackingFrames() {
  status_->SetCounter("frames_lacking", static_cast<int64_t>(lacking_.size()));
  status_->Set(status_->state(), StatusMessage());
}

std::string MapStore::StatusMessage() const {
  if (lacking_.empty()) return "";
  return "recovered after a crash; " + std::to_string(lacking_.size()) +
         " frames that the map had are lacking, sensors may send them again";
}

}  // namespace vismap
