#pragma once

#include <cstdint>
#include <list>
#include <string>

#include "freespace/occupancy.h"
#include "viewer/http_rules.h"
#include "viewer/log_recording.h"
#include "viewer/slice.h"

namespace vismap {

/// Answers GET /api/... about a log at a moment: the argument frames=N, without it at the newest.
class LogApi {
 public:
  /// `recording` must outlive it.
  LogApi(const LogRecording* recording, const OccupancyOptions& options)
      : recording_(recording), options_(options) {}
  HttpAnswer Get(HttpTarget target);

 private:
  HttpAnswer GetObjects(int64_t frames) const;
  HttpAnswer GetCell(const HttpTarget& target, int64_t frames) const;
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
};

}  // namespace vismap
