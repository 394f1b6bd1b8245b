#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vismap/process_status_t.hpp>

#include "runtime/status.h"
#include "wire/frame_key.h"

namespace vismap {

/// Counters of this name and a camera id in a STATUS are the utime of the camera's newest frame
/// that the process has seen.
inline constexpr const char* kNewestUtimeCounter = "newest_utime.camera";

/// How far a map is behind its cameras: in the time of the frames, and in the time that passes. It
/// has no clock of its own: callers pass the current time `now` [s]. At most 32 cameras are
/// followed.
class FrameLag {
 public:
  /// A frame exists: it has arrived, or another process has seen it.
  void Seen(const FrameKey& frame, double now);
  /// The same for all frames that a process tells of in its STATUS.
  void Seen(const process_status_t& status, double now);
  /// The map has the frame, or it is not going to have it.
  void Done(const FrameKey& frame);
  void Clear() {
    cameras_.clear();
    told_.clear();
  }

  /// Time of the newest frame that was seen minus that of the last one that is done [s], of the
  /// camera for which it is the largest; 0 = no frame is open.
  double DataSeconds() const;
  /// For how long the oldest open frame has been known [s].
  double WaitSeconds(double now) const;

 private:
  struct Camera {
    int64_t newest = 0;  // utime of the frame that was seen last [us]
    std::optional<int64_t> done;
    // (utime, when it was seen first) of the frames that are not done, in the order in which they
    // were seen. When there are too many, an entry stands for several frames.
    std::deque<std::pair<int64_t, double>> open;
  };
  void SeenBy(const std::string& source, const FrameKey& frame, double now);

  std::map<CameraId, Camera> cameras_;
  std::map<std::pair<std::string, CameraId>, int64_t> told_;  // by process: its newest frame [us]
};

/// Tells in STATUS the time of the newest frame of each camera that a process has seen, for
/// FrameLag.
class NewestTimes {
 public:
  /// `status` must outlive it.
  explicit NewestTimes(Status* status) : status_(status) {}
  void Saw(const FrameKey& frame);

 private:
  Status* status_;
  std::set<CameraId> cameras_;  // at most 32
};

}  // namespace vismap
