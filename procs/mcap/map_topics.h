#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>
#include <vismap/mesh_delta_t.hpp>

#include "mcap/scene_messages.h"
#include "wire/map_follower.h"
#include "wire/mesh_update.h"
#include "wire/update_sequence.h"

namespace vismap {

/// How often the map is written, and how.
struct MapTopicOptions {
  double changes_s = 1;  ///< changes of the surface, at most once in this time of the log [s]
  double whole_s = 5;    ///< the whole surface as points, and free space, likewise [s]
  Coloring coloring = Coloring::kInstance;  ///< of the triangles
  size_t most_points = 200000;  ///< of a cloud; of a larger surface every n-th vertex is taken, and
                                ///< free space is shown in larger cells
  FollowLimits limits{};        ///< of the copies of the surface and of free space
};

/// Whether a period is over; also when the clock of the log went back.
inline bool Passed(int64_t since_us, int64_t now_us, int64_t period_us) {
  return now_us < since_us || static_cast<double>(now_us) - static_cast<double>(since_us) >=
                                  static_cast<double>(period_us);
}

/// When something was written last, and whether it has changed since. Times are those of the log.
class WriteTimer {
 public:
  explicit WriteTimer(double period_s) : period_us_(static_cast<int64_t>(period_s * 1e6)) {}
  void MarkChanged() { changed_ = true; }
  bool changed() const { return changed_; }
  /// Whether there are changes, and enough time has passed since the last ones were written.
  bool IsDue(int64_t log_us) const {
    return changed_ && (!written_us_ || Passed(*written_us_, log_us, period_us_));
  }
  void MarkWritten(int64_t log_us) {
    changed_ = false;
    written_us_ = log_us;
  }

 private:
  int64_t period_us_;
  bool changed_ = false;
  std::optional<int64_t> written_us_;
};

/// The surface of a map: its changes on /map/surface, block by block, and all of it as points with
/// the colours that the camera saw on /map/surface_points. A viewer that jumps in time gets the
/// newest message of each topic only: all points, but of the blocks only those that changed last.
class SurfaceTopics {
 public:
  SurfaceTopics(const MapTopicOptions& options, FoxgloveFile* file)
      : options_(options), file_(*file), sequence_(options.limits) {}

  /// Follows the updates of a map server. kTooLarge: the surface needs more memory than the limits
  /// allow, and is forgotten.
  FollowOutcome Apply(const mesh_delta_t& message, int64_t log_us);
  /// Forgets the surface: another map begins.
  void Reset();
  /// Sets the surface of a block; without triangles it is gone. `utime` = of the newest frame.
  void Set(BlockMesh block, int64_t utime);

  /// Writes what is due.
  void WriteDue(int64_t log_us);
  /// Writes all changes.
  void Finish(int64_t log_us);

  int64_t gaps() const { return sequence_.gaps(); }  ///< how often an update was missing

 private:
  void WriteChanges(int64_t log_us);
  void WriteCloud(int64_t log_us);
  size_t bytes() const { return point_count_ * sizeof(CloudPoint) + pending_bytes_; }

  MapTopicOptions options_;
  FoxgloveFile& file_;
  UpdateSequence<std::vector<BlockMesh>> sequence_;
  std::string map_id_;
  int64_t utime_ = 0;
  std::map<BlockIndex, std::vector<CloudPoint>> points_;  // of each block with a surface
  size_t point_count_ = 0;
  std::map<BlockIndex, BlockMesh> pending_;  // changed since the last SurfaceMessage
  size_t pending_bytes_ = 0;
  bool reset_ = false;  // the next SurfaceMessage deletes all earlier blocks
  WriteTimer changes_{options_.changes_s}, cloud_{options_.whole_s};
};

/// Free space: the cells that are occupied on /map/occupied, those that are free on /map/free.
/// Cells get larger until neither has more than most_points.
class SpaceTopics {
 public:
  SpaceTopics(const MapTopicOptions& options, FoxgloveFile* file)
      : options_(options), file_(*file), follower_(options.limits) {}

  /// Follows the updates of a map server.
  FollowOutcome Apply(MapUpdate update, int64_t log_us);
  /// Sets free space as a whole. `utime` = of the newest frame.
  void Set(OccupancyMap map, int64_t utime);

  void WriteDue(int64_t log_us);
  void Finish(int64_t log_us);

  int64_t gaps() const { return follower_.gaps(); }  ///< how often an update was missing

 private:
  void WriteAll(int64_t log_us);
  const OccupancyMap* Newest() const;

  MapTopicOptions options_;
  FoxgloveFile& file_;
  MapFollower follower_;
  std::optional<OccupancyMap> whole_;  // what Set got
  int64_t utime_ = 0;
  WriteTimer timer_{options_.whole_s};
};

}  // namespace vismap
