#pragma once

#include <cstdint>
#include <list>
#include <string>

#include "freespace/occupancy.h"
#include "viewer/http_rules.h"
#include "viewer/log_recording.h"
#include "viewer/log_source.h"
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
  /// `max_map_bytes`.
  LogApi(const LogSource* source, const OccupancyOptions& options, size_t max_map_bytes);
  /// `reply` is called once, now or by Poll.
  void Get(HttpTarget target, const WebHandler::Reply& reply);
  /// Answers what had to wait. To be called often.
  void Poll();

 private:
  HttpAnswer GetObjects(int64_t frames) const;
  void GetCell(const HttpTarget& target, int64_t frames, const WebHandler::Reply& reply);
  HttpAnswer GetSlice(const HttpTarget& target, const Moment& moment);
  Result<const OccupancyMap*> SpaceAt(const Moment& moment);

  const LogRecording* recording_;
  OccupancyOptions options_;
  SliceAnswers slices_;
  // Free space at the moments that were asked for last, newest first.
  struct Space {
    int64_t frames;
    int64_t thinnings;
    OccupancyMap map;
  };
  std::list<Space> spaces_;
  MomentMaps maps_;
  struct CellQuestion {
    Eigen::Vector3d at_W;  // [m]
    int64_t frames = 0;
    double give_up = 0;  // MonotonicSeconds
    WebHandler::Reply reply;
  };
  bool Answer(const CellQuestion& question);
  std::list<CellQuestion> waiting_;
};

}  // namespace vismap
