#pragma once

#include <tsl/robin_set.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/config.h"
#include "freespace/occupancy_watch.h"
#include "mapping/integrate.h"
#include "objects/mesh_tracker.h"
#include "objects/object_tracker.h"
#include "session/map_session.h"
#include "viewer/log_evidence.h"
#include "viewer/log_recording.h"

namespace vismap {

/// Writes into a recording what a map becomes while a log is mapped, see MapSequence.
class LogRecorder {
 public:
  /// All must outlive it. `frames`: keeps frames to show objects in; nullptr = none are kept.
  LogRecorder(const VismapConfig& config, const MapSession* session, LogRecording* recording,
              LogFrames* frames = nullptr);

  /// A frame before it is mapped.
  void OnSegmented(const SegmentedFrame& frame);
  /// What it changed.
  void OnMapped(const MapDelta& delta);
  /// The log has ended: the last moment, with all objects measured anew.
  void Finish();
  /// Why nothing is recorded any more, a sentence; "" = it is.
  const std::string& failure() const { return failure_; }

 private:
  void AddMoment();
  std::vector<RecordedBlock> SurfaceChanges();
  std::vector<RecordedBlock> SpaceChanges();
  void AddObjects(const std::vector<ObjectSummary>& objects, const UpDirection& up);
  void AddMarks(const std::vector<ObjectSummary>& objects);
  void AddCopyIfDue();
  void AddCopy(size_t max_bytes);
  void Expect(const Result<void>& outcome);
  const SemanticMap& map() const { return session_->map(); }

  const VismapConfig& config_;
  const MapSession* session_;
  LogRecording* recording_;
  LogFrames* frames_;
  MeshTracker mesh_;
  ObjectTracker objects_;
  OccupancyWatch space_;
  CameraView view_;                          // of the frame that is being mapped
  std::vector<uint8_t> picture_;             // of it
  std::shared_ptr<EvidenceFrame> evidence_;  // the same frame, when it is to be kept
  std::vector<BlockIndex> changed_;          // since the last moment
  tsl::robin_set<BlockIndex, BlockIndexHash> changed_since_copy_;
  int64_t recorded_ = 0;  // frames of the last moment
  // Of the frame of the last list, not the map's: that one stays far ahead after one wrong time.
  std::optional<int64_t> objects_utime_;
  std::map<std::string, std::string> present_;  // objects in the last list: id and name
  std::string failure_;
};

}  // namespace vismap
