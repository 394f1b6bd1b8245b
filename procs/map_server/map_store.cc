#include "map_server/map_store.h"

#include <utility>

#include "base/file.h"
#include "runtime/log.h"

namespace vismap {

MapStore::MapStore(const MapServerOptions& options, Status* status)
    : path_(options.save_on_exit),
      folder_(options.map_folder, static_cast<uint64_t>(options.map_folder_mb) << 20),
      saves_periodically_(options.save_period_s > 0),
      save_pacer_(options.save_period_s),
      status_(status) {
  if (!options.map_folder.empty()) RemoveStaleTemporariesIn(options.map_folder, ".vismap");
  if (!path_.empty()) RemoveStaleTemporaries(path_);
}

void MapStore::BeginMap(const MapSession& session) {
  saved_.BeginMap(session.metadata().map_id);
  journal_.BeginMap();
}

void MapStore::ContinueMap(const MapSession& session, const std::filesystem::path& path) {
  BeginMap(session);
  saved_.WasLoadedFrom(path, session.map().revision);
}

Result<RecoveredMap> MapStore::Recover(const MapSessionOptions& options,
                                       const std::string& map_id) {
  Result<RecoveredMap> recovered = RecoverMap(path_, options, map_id);
  if (!recovered) return recovered;
  for (const std::string& sentence : recovered->unusable) Report(sentence);
  return recovered;
}

namespace {

std::string Sentence(const SaveInfo& saved) {
  return "saved " + std::to_string(saved.bytes) + " bytes to " + saved.path.string() +
         ", map hash " + saved.map_hash;
}

}  // namespace

/// Where the map is saved under a name, or as configured when that is empty.
Result<std::filesystem::path> MapStore::PathFor(const std::string& name) const {
  if (name.empty() && path_.empty())
    return Fail(
        "no name given to save the map as, and no file configured (map_server.save_on_exit)");
  if (name.empty()) return path_;
  // A name that cannot be used must not make the folder.
  if (const Result<void> checked = CheckMapName(name); !checked)
    return tl::unexpected(checked.error());
  if (!folder_.path().empty()) {
    if (const Result<void> made = CreateFolder(folder_.path()); !made)
      return tl::unexpected(made.error());
  }
  return folder_.ForSaving(name);
}

Result<std::string> MapStore::Save(const MapSession& session) {
  const auto path = PathFor("");
  if (!path) return tl::unexpected(path.error());
  return SaveTo(*path, session);
}

Result<std::string> MapStore::SaveNamed(const MapSession& session, const std::string& name) {
  if (const Result<void> checked = CheckMapName(name); !checked)
    return tl::unexpected(checked.error());
  const auto path = PathFor(name);
  if (!path) return tl::unexpected(path.error());
  return SaveTo(*path, session);
}

Result<std::string> MapStore::SaveTo(const std::filesystem::path& path, const MapSession& session) {
  const Result<SaveInfo> saved = saved_.Save(session.map(), session.metadata(), path);
  if (!saved) return tl::unexpected(saved.error());
  if (path == path_ && !journal_.MapWasSaved(journal_.Mark()))
    LogWarningRateLimited("journal", "cannot write the journal");
  return Sentence(*saved);
}

Result<MapStore::LateSave> MapStore::BeginSave(const std::string& name) {
  const auto path = PathFor(name);
  if (!path) return tl::unexpected(path.error());
  ++late_saves_;
  return LateSave{*path, journal_.Mark()};
}

Result<std::string> MapStore::SaveCopy(const LateSave& save, const MapSnapshot& copy) {
  const Result<SaveInfo> saved = saved_.Save(copy.map, copy.metadata, save.path);
  if (!saved) return tl::unexpected(saved.error());
  return Sentence(*saved);
}

void MapStore::EndSave(const LateSave& save, const MapSnapshot& copy, bool was_saved,
                       const MapSession& session) {
  --late_saves_;
  const bool of_this_map = copy.metadata.map_id == session.metadata().map_id;
  if (was_saved && of_this_map && save.path == path_ && !journal_.MapWasSaved(save.journal_mark))
    LogWarningRateLimited("journal", "cannot write the journal");
}

void MapStore::SaveIfDue(const MapSession& session, double share) {
  if (!saves_periodically_ || late_saves_ > 0 || session.map().revision == 0 ||
      saved_.HasRevision(path_, session.map().revision) ||
      SavedMaps::WouldLose(session.map(), path_)) {
    return;
  }
  const auto save = [&] {
    const Result<std::string> saved = Save(session);
    std::optional<std::string> trouble;
    if (!saved) trouble = "the map is not saved: " + saved.error().message;
    status_->SetFinding("saving", trouble);
  };
  save_pacer_.RunIfDue(save, share);
}

Result<std::string> MapStore::SaveAtEnd(const MapSession& session) {
  if (SavedMaps::WouldLose(session.map(), path_))
    return "the map is empty, so the saved map " + path_.string() + " stays as it is";
  return Save(session);
}

void MapStore::StartJournal(const MapSession& session) {
  const std::filesystem::path journal = path_.string() + ".journal";
  ReadJournal(journal, session);
  ShowLackingFrames();
  Result<CommitJournal> opened = CommitJournal::Open(journal);
  if (opened) {
    journal_ = std::move(*opened);
  } else {
    Report(opened.error().message +
           "; after a crash it will not be known which frames are lacking");
  }
}

void MapStore::ReadJournal(const std::filesystem::path& journal, const MapSession& session) {
  const Result<std::vector<FrameKey>> integrated = CommitJournal::Read(journal);
  if (integrated) {
    for (const FrameKey& frame : *integrated) {
      if (!session.Contains(frame.camera_id, frame.utime)) lacking_.insert(frame);
    }
    return;
  }
  const Result<std::filesystem::path> aside = SetAside(journal, "unusable");
  Report(integrated.error().message + "; " +
         (aside ? "the file is " + aside->string() + " now" : aside.error().message));
}

void MapStore::AddFrame(const FrameKey& frame) {
  if (!journal_.Add(frame)) {
    status_->Count("journal_errors");
    LogWarningRateLimited("journal", "cannot write the journal: is the disk full?");
  }
  if (lacking_.erase(frame) > 0) ShowLackingFrames();
}

// Tells about a file that cannot be used, in the log and in STATUS.
void MapStore::Report(const std::string& unusable) {
  unusable_.push_back(unusable);
  status_->SetFindings("files", unusable_);
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
