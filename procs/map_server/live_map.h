#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "config/config.h"
#include "map_server/frame_history.h"
#include "map_server/map_memory.h"
#include "map_server/map_publisher.h"
#include "map_server/map_snapshot.h"
#include "map_server/map_store.h"
#include "runtime/bus.h"
#include "runtime/pacer.h"
#include "runtime/status.h"
#include "session/map_frame.h"

namespace vismap {

/// The map of a server while it is made: with everything that has to happen when a frame changes it
/// or another map takes its place.
class LiveMap {
 public:
  /// Starts with an empty map. `bus` and `status` must outlive it.
  LiveMap(const VismapConfig& config, Bus* bus, Status* status);

  /// Integrates a frame that the map does not contain, enters it in the journal, and publishes the
  /// space that it changed. Does none of it when the map refuses the frame, see MapDelta::refused.
  MappedFrame Integrate(const SegmentedFrame& frame);
  /// Keeps the message of the frame that was integrated last, if the config says so.
  void KeepFrame(segmented_frame_t message, const frame_commit_t& commit) {
    history_.AddFrame(std::move(message), commit, *session_);
  }
  /// Publishes surface and objects and saves the map, if they have changed and are due. Each takes
  /// at most `share` of the time.
  void PublishAndSaveIfDue(double share);
  /// Repeats the last state of each stream now and then.
  void Repeat() { publisher_.Repeat(*session_); }
  /// Publishes everything anew.
  void PublishAll() { publisher_.PublishAll(*session_); }

  /// Replaces the map by the saved one at a path. Returns a sentence. Publishes nothing.
  Result<std::string> Load(const std::filesystem::path& path);
  /// The same for a map that a client calls `name`, see MapFolder.
  Result<std::string> LoadNamed(const std::string& name);
  /// Continues the map that was saved last, if there is one, after a crash or a stop. Returns a
  /// sentence that says how many frames it lacks. Starts the journal of the map, see MapStore.
  Result<std::string> Recover();
  /// Saves the map as configured. Returns a sentence with the absolute path.
  Result<std::string> Save() { return store_.Save(*session_); }
  /// The map as it is now, to be read by another thread, which must call Complete first. Takes
  /// little time.
  std::shared_ptr<MapSnapshot> Snapshot() const;
  /// Saves the map as configured when the server ends. Returns a sentence.
  Result<std::string> SaveAtEnd() { return store_.SaveAtEnd(*session_); }
  /// Replaces the map by an empty one. Publishes nothing.
  void Reset();
  /// Replaces the map by one of the same frames with other poses, and publishes that. Returns the
  /// map that was there.
  std::unique_ptr<MapSession> ReplaceByCorrected(MapSession session);
  /// What it takes of memory.
  std::vector<MemoryLayer> Memory();
  /// Tells it in STATUS, as counters memory.LAYER_bytes, now and then.
  void ReportMemoryIfDue();

  const MapSession& session() const { return *session_; }
  MapPublisher& publisher() { return publisher_; }
  MapStore& store() { return store_; }
  FrameHistory& history() { return history_; }
  /// Names the frames of the map: another one after a reset and a load, the same after a correction
  /// of poses.
  const std::string& frames_id() const { return frames_id_; }
  /// What people should know about the map; empty = all is well.
  std::string StatusMessage() const { return store_.StatusMessage(); }

 private:
  MapMetadata NewMetadata() const;
  void Start(MapSession session);
  void StartEmpty();
  std::string Continue(MapSession session, const std::filesystem::path& path);
  std::vector<FrameKey> TakeFramesFromJournal(std::string* sentence);

  VismapConfig config_;
  Bus* bus_;
  Status* status_;
  MapPublisher publisher_;
  MapStore store_;
  FrameHistory history_;
  std::string frames_id_;
  std::unique_ptr<MapSession> session_;
  SharedTrajectory trajectory_;                    // that of the session
  mutable std::weak_ptr<const MapSnapshot> copy_;  // the newest one
  Pacer memory_pacer_{5.0};
};

}  // namespace vismap
