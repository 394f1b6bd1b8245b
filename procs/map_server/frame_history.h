#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "config/config.h"
#include "map_server/checkpoints.h"
#include "map_server/frame_journal.h"
#include "map_server/object_links.h"
#include "runtime/status.h"
#include "session/map_frame.h"

namespace vismap {

/// A frame that was integrated again.
struct ReplayedFrame {
  MappedFrame mapped;
  std::vector<SeenSegment> seen;
};

/// Integrates a frame of the journal with this pose. Fails when it cannot be decoded, when the map
/// has it already, and when the map refuses it.
Result<ReplayedFrame> ReplayFrame(const segmented_frame_t& message, const Pose& T_W_C,
                                  MapSession* session);

/// A map after a crash, with what the journal of frames has of it.
struct ContinuedMap {
  MapSession session;
  std::vector<FrameKey> taken;       ///< frames that were taken from the journal
  bool made_anew = false;            ///< the session is not the given one with more frames
  std::vector<std::string> remarks;  ///< for people: what is missing or damaged
};

/// What the map of a server was made of: its frames (FrameJournal) and, when poses may be
/// corrected, copies of it as it was before (Checkpoints). STATUS has how many frames are kept and
/// what is wrong with the journal.
class FrameHistory {
 public:
  /// Keeps nothing unless the config says so (map_server.frame_journal_mb). `status` must outlive
  /// it.
  FrameHistory(const VismapConfig& config, Status* status);

  /// nullptr: nothing is kept.
  FrameJournal* journal() const { return journal_.get(); }
  /// Why nothing is kept; empty when that is not the case.
  const std::string& why_off() const { return why_off_; }
  Checkpoints& checkpoints() { return checkpoints_; }
  /// Whether the journal is of the map of the server.
  bool begun() const { return begun_; }

  bool has_corrected_poses() const { return journal_ && journal_->has_corrections(); }
  /// The server has another map from now on.
  void BeginMap();
  /// Call it before each frame, which may be the first one of a map.
  void BeforeFrame(const MapSession& session);
  /// The frame went into the map of the session as the last one.
  void AddFrame(segmented_frame_t message, const frame_commit_t& commit, const MapSession& session);
  /// What frame `revision`, the last one of the map, shows of it. Kept when poses may be corrected.
  void Saw(int64_t revision, std::vector<SeenSegment> seen);
  /// What these frames show of the map since it was made again.
  void SawAgain(SeenByFrame seen);
  /// Of the last 20000 frames, as far as they came since the start or were taken from the journal.
  const SeenByFrame& seen() const { return seen_; }
  /// While the map has not the poses of the journal, no copies of it are kept.
  void SetMapIsOutdated(bool outdated) { outdated_ = outdated; }

  /// After a crash: frames that the saved map lacks are integrated. When the journal is of another
  /// map, that one is made anew from its first frame; what cannot be used is set aside. `empty`: of
  /// a map that is made anew.
  ContinuedMap Continue(MapSession saved, MapMetadata empty);

 private:
  bool Agrees(const MapSession& saved, const std::vector<JournaledFrame>& frames) const;
  void KeepCopyIfDue(const MapSession& session);
  void TakeFrames(const std::vector<JournaledFrame>& frames, ContinuedMap* map);
  void ShowStatus();

  MapSessionOptions options_;
  Status* status_;
  Checkpoints checkpoints_;
  std::unique_ptr<FrameJournal> journal_;
  std::string why_off_ = "no frames are kept (map_server.frame_journal_mb)";
  SeenByFrame seen_;
  bool keeps_copies_, begun_ = false, outdated_ = false;
};

}  // namespace vismap
