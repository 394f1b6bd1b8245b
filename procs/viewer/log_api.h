#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "config/config.h"
#include "viewer/answer_thread.h"
#include "viewer/http_rules.h"
#include "viewer/leaves.h"
#include "viewer/log_evidence.h"
#include "viewer/log_recording.h"
#include "viewer/log_source.h"
#include "viewer/moment_files.h"
#include "viewer/moment_maps.h"
#include "viewer/slice.h"
#include "viewer/web_server.h"

namespace vismap {

/// Answers GET /api/... about a log at a moment: the argument frames=N, without it at the newest.
class LogApi {
 public:
  static constexpr double kLongestWait = 12;  ///< for a map that has to be computed [s]
  static constexpr size_t kMostWaiting = 16;  ///< questions

  /// `source` must outlive it. Maps that have to be computed are kept while they take at most about
  /// viewer.max_map_mb.
  LogApi(const LogSource* source, const VismapConfig& config);
  /// `reply` is called once, now or by Poll.
  void Get(HttpTarget target, const WebHandler::Reply& reply);
  /// Answers what had to wait. To be called often.
  void Poll();

 private:
  using SpacePtr = std::shared_ptr<const OccupancyMap>;
  using UseMap = std::function<void(const MomentMaps::MapPtr& map, const WebHandler::Reply& reply)>;

  void GetAt(const HttpTarget& target, const Moment& moment, const WebHandler::Reply& reply);
  HttpAnswer GetObjects(int64_t frames) const;
  void GetCell(const HttpTarget& target, int64_t frames, const WebHandler::Reply& reply);
  void GetObjectFile(const std::string& name, int64_t frames, const WebHandler::Reply& reply);
  void GetSlice(const HttpTarget& target, const Moment& moment, const WebHandler::Reply& reply);
  void GetDistances(const Slice& slice, const SliceQuestion& question, const Moment& moment,
                    const WebHandler::Reply& reply);
  void GetLeaves(const HttpTarget& target, const Moment& moment, const WebHandler::Reply& reply);
  void GetEvidence(const HttpTarget& target, int64_t frames, const WebHandler::Reply& reply);
  void GetFrame(const HttpTarget& target, int64_t frames, const WebHandler::Reply& reply);
  /// Calls `use` with the map after so many frames, now or when it is computed.
  void WithMap(int64_t frames, const WebHandler::Reply& reply, UseMap use);
  Result<SpacePtr> SpaceAt(const Moment& moment);
  FollowerPosition PositionOf(const Moment& moment) const {
    return {recording_->map_id(), moment.frames};
  }

  const LogRecording* recording_;
  VismapConfig config_;
  SliceAnswers slices_;
  LeafAnswers leaves_{0};
  // Free space at the moments that were asked for last, newest first.
  struct Space {
    int64_t frames;
    int64_t thinnings;
    SpacePtr map;
  };
  std::list<Space> spaces_;
  MomentMaps maps_;
  struct MapQuestion {
    int64_t frames = 0;
    double give_up = 0;  // MonotonicSeconds
    WebHandler::Reply reply;
    UseMap use;
  };
  bool Answer(const MapQuestion& question);
  std::list<MapQuestion> waiting_;
  LogEvidence evidence_;  // used by the thread alone
  ObjectFiles files_;     // the same
  AnswerThread thread_;   // last, so that it ends first
};

}  // namespace vismap
