#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "base/result.h"
#include "config/process_options.h"
#include "map_server/commit_journal.h"
#include "map_server/map_snapshot.h"
#include "map_server/saved_maps.h"
#include "mapfile/map_folder.h"
#include "runtime/pacer.h"
#include "runtime/status.h"
#include "session/map_session.h"

namespace vismap {

/// Keeps the map of a server on disk: saves it, on request and now and then, finds it again at the
/// start, and after a crash knows which frames the saved map lacks that the lost one had (by a
/// journal beside the file, PATH.journal). What it does so that no saved map is lost: SavedMaps.
class MapStore {
 public:
  /// `status` must outlive it.
  MapStore(const MapServerOptions& options, Status* status);

  /// From now on this map is saved, of which nothing is saved yet.
  void BeginMap(const MapSession& session);
  /// The same for a map that was read from a file.
  void ContinueMap(const MapSession& session, const std::filesystem::path& path);

  /// Reads the map that was saved last, or an older one when that cannot be used, see RecoverMap.
  Result<RecoveredMap> Recover(const MapSessionOptions& options, const std::string& map_id);
  /// The file of the map that a client calls `name`.
  Result<std::filesystem::path> FindNamed(const std::string& name) const {
    return folder_.ForLoading(name);
  }

  /// Saves the map as configured. Returns a sentence with the absolute path.
  Result<std::string> Save(const MapSession& session);
  /// Saves the map for a client under this name, see MapFolder.
  Result<std::string> SaveNamed(const MapSession& session, const std::string& name);

  /// A save that another thread does with a copy of the map.
  struct LateSave {
    std::filesystem::path path;
    size_t journal_mark = 0;
  };
  /// Begins to save the map under a name, or as configured when that is empty. EndSave must follow.
  Result<LateSave> BeginSave(const std::string& name);
  /// Saves the copy; another thread may do it. Returns a sentence.
  Result<std::string> SaveCopy(const LateSave& save, const MapSnapshot& copy);
  /// `session`: of the map as it is now.
  void EndSave(const LateSave& save, const MapSnapshot& copy, bool was_saved,
               const MapSession& session);
  /// Saves the map as configured if it has changed and the period is over. It takes at most `share`
  /// of the time. A failure is a finding in STATUS.
  void SaveIfDue(const MapSession& session, double share = kUsualShare);
  /// Saves the map when the server ends. An empty map leaves an older file as it is.
  Result<std::string> SaveAtEnd(const MapSession& session);

  /// Reads the journal of the process that saved the map of the session last: frames that it names
  /// and the session does not contain are lacking. The journal is continued from here on. What
  /// cannot be used as a journal is set aside.
  void StartJournal(const MapSession& session);
  /// Enters a frame in the journal, if that was started. It is not lacking any more.
  void AddFrame(const FrameKey& frame);
  size_t lacking_frames() const { return lacking_.size(); }
  /// Tells how many frames are lacking; empty = none.
  std::string StatusMessage() const;

 private:
  Result<std::filesystem::path> PathFor(const std::string& name) const;
  Result<std::string> SaveTo(const std::filesystem::path& path, const MapSession& session);
  void ReadJournal(const std::filesystem::path& journal, const MapSession& session);
  void Report(const std::string& unusable);
  void ShowLackingFrames();

  std::filesystem::path path_;
  MapFolder folder_;
  bool saves_periodically_;
  Pacer save_pacer_;
  Status* status_;
  SavedMaps saved_;
  CommitJournal journal_;
  std::set<FrameKey> lacking_;
  int late_saves_ = 0;                 // that have begun and not ended
  std::vector<std::string> unusable_;  // what was set aside at the start, for people
};

}  // namespace vismap
