#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "base/result.h"
#include "map_server/commit_journal.h"
#include "runtime/pacer.h"
#include "runtime/status.h"
#include "session/map_session.h"

namespace vismap {

/// Keeps a map on disk: saves it, on request and now and then, loads it again, and after a crash
/// knows which frames the saved map lacks that the lost one had (by a journal beside the file,
/// PATH.journal).
class MapStore {
 public:
  /// `path`: where the map is saved unless a request names another file; empty = nowhere.
  /// `save_period_s` [s]: how often SaveIfDue saves; 0 = never. `status` must outlive it.
  MapStore(std::filesystem::path path, double save_period_s, Status* status);

  /// Loads a map and gives it `map_id`, so that its revisions are not mistaken for those of the map
  /// that was saved. Fails with the path and the reason.
  static Result<MapSession> Load(const std::string& path, const MapSessionOptions& options,
                                 std::string map_id);

  /// Saves the map; `path` empty = the configured one. Returns a sentence with the absolute path.
  Result<std::string> Save(const MapSession& session, const std::string& path = "");
  /// Saves the map to the configured path if it has changed and the period is over. Logs failures.
  void SaveIfDue(const MapSession& session);

  /// Reads the journal of the process that saved the map of the session last: frames that it names
  /// and the session does not contain are lacking. The journal is continued from here on.
  Result<void> StartJournal(const MapSession& session);
  /// Enters a frame in the journal, if that was started. It is not lacking any more.
  void AddFrame(const FrameKey& frame);
  size_t lacking_frames() const { return lacking_.size(); }
  /// Tells how many frames are lacking; empty = none.
  std::string StatusMessage() const;

 private:
  void ShowLackingFrames();

  std::filesystem::path path_;
  bool saves_periodically_;
  Pacer save_pacer_;
  Status* status_;
  int64_t saved_revision_ = 0;  // of the last save to `path_`
  CommitJournal journal_;
  std::set<FrameKey> lacking_;
};

}  // namespace vismap
