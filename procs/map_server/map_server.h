#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "config/config.h"
#include "freespace/occupancy_map.h"
#include "runtime/bus.h"
#include "runtime/status.h"
#include "session/map_session.h"
#include "session/outputs.h"
#include "wire/frame_order.h"

namespace vismap {

/// Owns the map: takes SEGMENTED_FRAMEs in the order their source asks for, answers each with a
/// MAP_COMMIT, publishes what changed (MAP_DELTA after every frame, MESH_DELTA and OBJECTS now and
/// then), and carries out MAP_REQUESTs.
class MapServer {
 public:
  /// Subscribes to its inputs. `bus` and `status` must outlive it.
  MapServer(const VismapConfig& config, Bus* bus, Status* status);

  /// Continues the map at a path, as a load request does.
  Result<std::string> Load(const std::string& path);
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
  void PublishDelta(const std::vector<BlockIndex>& changed);
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

  void PublishMesh(bool full);
  std::vector<ObjectSummary> PublishObjects();
  void PublishSnapshot();
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
  OccupancyMap occupancy_;
  FrameOrder<segmented_frame_t> order_{256};  // frames whose predecessors were lost on the way
  std::vector<BlockIndex> mesh_dirty_;        // changed since the last MESH_DELTA, unsorted
  int64_t mesh_revision_ = -1;                // of the last MESH_DELTA
  int64_t objects_revision_ = 0;              // of the last OBJECTS
  int64_t saved_revision_ = 0;                // of the last save
  double mesh_due_ = 0, objects_due_ = 0, save_due_ = 0;  // MonotonicSeconds
  std::deque<map_reply_t> recent_replies_;  // so that a repeated request is not carried out twice
};

}  // namespace vismap
