#pragma once

#include <deque>
#include <memory>
#include <set>
#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/object_list_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "config/config.h"
#include "exports/outputs.h"
#include "map_server/camera_clocks.h"
#include "map_server/commit_journal.h"
#include "map_server/mesh_publisher.h"
#include "map_server/occupancy_publisher.h"
#include "objects/object_tracker.h"
#include "runtime/bus.h"
#include "runtime/status.h"
#include "session/map_session.h"
#include "wire/frame_order.h"

namespace vismap {

/// Owns the map: takes SEGMENTED_FRAMEs in the order their source asks for, answers each with a
/// MAP_COMMIT, publishes what changed (MAP_DELTA after every frame, MESH_DELTA and OBJECTS now and
/// then), and carries out MAP_REQUESTs. No frame is integrated twice.
class MapServer {
 public:
  /// Subscribes to its inputs. `bus` and `status` must outlive it.
  MapServer(const VismapConfig& config, Bus* bus, Status* status);

  /// Continues the map at a path, as a load request does.
  Result<std::string> Load(const std::string& path);
  /// Goes on from what was saved last, if there is anything; says how many frames that lacks which
  /// the map had when the server died. Starts the journal that tells so the next time.
  Result<std::string> Recover();
  /// What people should know; empty = all is well.
  std::string StatusMessage() const;
  /// Saves the map; returns a sentence with the absolute path.
  Result<std::string> Save(const std::string& path);

 private:
  struct Answer {
    std::string message;
    std::string encoding;
    std::vector<uint8_t> payload;
  };
  using Handler = Result<Answer> (MapServer::*)(const map_request_t&);

  Result<void> OnFrame(const segmented_frame_t& message);
  Result<void> TakeMessage(const segmented_frame_t& message);
  frame_commit_t TakeFrame(const SegmentedFrame& frame, std::string input_digest);
  void Skip(const segmented_frame_t& message, const std::string& reason);
  void NoteIntegrated(const FrameKey& frame);
  void ShowLacking();
  void PublishNowAndThen();
  void SaveNowAndThen();

  void OnRequest(const map_request_t& request);
  Result<Answer> Answered(const map_request_t& request);
  Result<Answer> AnswerSave(const map_request_t& request);
  Result<Answer> AnswerLoad(const map_request_t& request);
  Result<Answer> AnswerReset(const map_request_t& request);
  Result<Answer> AnswerObjects(const map_request_t& request);
  Result<Answer> AnswerMesh(const map_request_t& request);
  Result<Answer> AnswerOctree(const map_request_t& request);
  Result<Answer> AnswerStatistics(const map_request_t& request);
  Result<Answer> AnswerSnapshot(const map_request_t& request);
  Result<Answer> AnswerFrames(const map_request_t& request);

  void PublishMesh();
  void PublishAll();
  void PublishObjectsNow();
  std::vector<ObjectSummary> PublishObjects(std::vector<ObjectSummary> objects);
  std::vector<ObjectSummary> AllObjects() const;
  void Repeat();
  void StartMap(MapSession session);
  MapMetadata NewMetadata() const;

  const SemanticMap& map() const { return session_->map(); }
  const std::string& map_id() const { return session_->metadata().map_id; }

  VismapConfig config_;
  MapSessionOptions session_options_;
  OutputOptions outputs_;
  Bus* bus_;
  Status* status_;
  std::unique_ptr<MapSession> session_;
  OccupancyPublisher occupancy_;
  MeshPublisher mesh_;
  ObjectTracker tracker_;
  object_list_t objects_;                     // the last OBJECTS
  FrameOrder<segmented_frame_t> order_{256};  // frames whose predecessors were lost on the way
  std::set<FrameKey> skipped_;                // answered, but not integrated
  CameraClocks clocks_;
  CommitJournal journal_;
  std::set<FrameKey> lacking_;    // of the map before a crash, not in this one yet
  int64_t objects_revision_ = 0;  // of the last OBJECTS
  int64_t saved_revision_ = 0;    // of the last save
  double mesh_due_ = 0, objects_due_ = 0, save_due_ = 0,
         objects_repeat_due_ = 0;           // MonotonicSeconds
  std::deque<map_reply_t> recent_replies_;  // so that a repeated request is not carried out twice
};

}  // namespace vismap
