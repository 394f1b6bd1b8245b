#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"
#include "mapfile/map_file.h"
#include "viewer/page_messages.h"
#include "viewer/version_table.h"

namespace vismap {

/// What the map was at one moment.
struct Moment {
  int64_t frames = 0;  ///< that the map was made of
  int64_t utime = 0;   ///< of the newest of them [us]
  size_t blocks = 0;   ///< with a surface
  size_t triangles = 0;
  uint64_t digest = 0;  ///< sum of the hashes of all blocks, modulo 2^64
};

/// A block that has changed, as it goes into the recording.
struct RecordedBlock {
  BlockIndex index;
  uint64_t hash = 0;  ///< 0 = it has nothing now
  uint32_t triangles = 0;
  std::vector<uint8_t> bytes{};  ///< compressed
};

/// An object has come, or has gone.
struct ObjectMark {
  int64_t frames = 0;
  int64_t utime = 0;  ///< [us]
  std::string id;     ///< of the object for the page: its instance
  std::string name;   ///< of its class
  bool appeared = true;
};

/// How far the log is mapped.
struct RecordingState {
  int64_t total = 0;    ///< frames of the log
  int64_t read = 0;     ///< of these, mapped or left out
  int64_t mapped = 0;   ///< frames in the map
  bool done = false;    ///< no frame will come any more
  std::string message;  ///< what a person should know, sentences; empty = nothing
};

/// The surface of a block at a moment.
struct BlockAtMoment {
  FrameBytes bytes;  ///< see EncodePageBlock; nullptr = none
  uint64_t hash = 0;
};

/// How a map grew: its surface, its free space, objects, cameras and pictures at each of many
/// moments. One thread writes, others read. On disk it takes at most about `max_bytes`: beyond,
/// every second moment is forgotten, and from then on half as many are added.
class LogRecording {
 public:
  static constexpr size_t kLeastMoments = 4;  ///< so many are never thinned out
  static constexpr size_t kMostMarks = 1000;

  /// `folder`: see SpillFile::Open.
  static Result<std::unique_ptr<LogRecording>> Open(const std::string& folder, uint64_t max_bytes,
                                                    std::string map_id);

  // For the thread that maps. Each returns an Error when the disk is full; the recording then ends.

  /// A frame that was mapped. `picture`: see EncodePicture, may be empty.
  Result<void> AddFrame(const CameraView& view, const std::vector<uint8_t>& picture);
  /// The map as it is now, by what has changed since the last moment.
  Result<void> AddMoment(int64_t frames, int64_t utime, const std::vector<RecordedBlock>& surface,
                         const std::vector<RecordedBlock>& space);
  /// Objects from this number of frames on: the page's text (ObjectsText), and objects.json.
  Result<void> AddObjects(int64_t frames, const std::string& text, const std::string& json);
  void AddMark(ObjectMark mark);
  /// A copy of the map, and the blocks that it does not share with the copy before, in any order.
  /// Copies take at most about `max_bytes` together; beyond, every second one is dropped.
  void AddCopy(int64_t frames, std::shared_ptr<const LoadedMap> map,
               std::vector<BlockIndex> changed, size_t max_bytes);
  void SetState(RecordingState state);
  void SetGrid(double voxel_size_m, double block_edge_m);
  /// Of the newest version of a block; 0 = it has no surface.
  uint64_t HashOf(BlockIndex index) const;
  /// Frames from one moment to the next.
  int64_t stride() const { return stride_; }
  /// Frames from one copy to the next.
  int64_t copy_stride() const { return copy_stride_; }

  // For readers.

  const std::string& map_id() const { return map_id_; }
  double voxel_size_m() const { return voxel_size_m_; }
  double block_edge_m() const { return block_edge_m_; }
  RecordingState state() const;
  std::vector<Moment> moments() const;
  std::vector<ObjectMark> marks() const;
  /// Changes with everything that is added.
  int64_t changes() const { return changes_; }
  /// Changes when moments are forgotten: what was read of others may be wrong.
  int64_t thinnings() const { return thinnings_; }
  /// Lists of objects that were added. The newest moment has its list a while after it is there.
  int64_t object_lists() const { return object_lists_; }
  /// The newest moment of at most so many frames, else the first one; nullopt before that.
  std::optional<Moment> MomentAt(int64_t frames) const;
  std::optional<Moment> Newest() const;

  /// The hashes of all blocks with a surface, in no order.
  std::vector<std::pair<BlockIndex, uint64_t>> SurfaceAt(int64_t frames) const;
  Result<BlockAtMoment> BlockAt(BlockIndex index, int64_t frames) const;
  Result<OccupancyMap> SpaceAt(int64_t frames) const;
  /// "" when there are none yet.
  Result<std::string> ObjectsTextAt(int64_t frames) const;
  Result<std::string> ObjectsJsonAt(int64_t frames) const;
  /// Of each camera its newest frame, and how many positions its path has then.
  std::vector<std::pair<CameraView, int64_t>> CamerasAt(int64_t frames) const;
  /// The newest picture of a camera; nullptr when it has none.
  Result<FrameBytes> PictureAt(int camera_id, int64_t frames) const;
  /// Camera and position of the frames from number `from` on [m].
  std::vector<std::pair<int, std::array<float, 3>>> PathFrom(size_t from) const;
  /// The newest copy of the map of at most so many frames, else the first; nullptr = there is none.
  std::shared_ptr<const LoadedMap> CopyAt(int64_t frames) const;

  uint64_t disk_bytes() const;
  size_t index_bytes() const;

 private:
  struct RecordedFrame {
    CameraView view;
    SpillFile::Place picture;
  };
  struct ObjectTexts {
    int64_t frames = 0;
    SpillFile::Place text, json;
  };
  LogRecording(SpillFile disk, uint64_t max_bytes, std::string map_id)
      : map_id_(std::move(map_id)), max_bytes_(max_bytes), disk_(std::move(disk)) {}

  Result<void> AddVersions(int64_t frames, const std::vector<RecordedBlock>& blocks,
                           VersionTable* table);
  Result<void> EnterMoment(int64_t frames, int64_t utime, const std::vector<RecordedBlock>& surface,
                           const std::vector<RecordedBlock>& space);
  bool IsTooLarge() const;
  Result<void> ThinIfTooLarge();
  std::vector<uint32_t> ThinOut();
  Result<void> ForgetEverySecond();
  Result<void> MovePart(uint32_t part);
  Result<std::vector<uint8_t>> ReadText(const SpillFile::Place& place) const;
  Result<std::string> ObjectsAt(int64_t frames, SpillFile::Place ObjectTexts::*which) const;
  size_t IndexBytes() const;

  const std::string map_id_;
  const uint64_t max_bytes_;
  std::atomic<double> voxel_size_m_ = 0, block_edge_m_ = 0;
  std::atomic<int64_t> stride_ = 1, copy_stride_ = 16, changes_ = 0, thinnings_ = 0,
                       object_lists_ = 0;

  mutable std::mutex mutex_;  // of all that follows
  SpillFile disk_;
  RecordingState state_;
  std::vector<Moment> moments_;
  VersionTable surface_, space_;
  std::vector<RecordedFrame> frames_;
  std::map<int, std::vector<int64_t>> frames_of_;  // numbers of frames by camera, ascending
  std::vector<ObjectTexts> objects_;
  std::vector<ObjectMark> marks_;
  struct Copy {
    std::shared_ptr<const LoadedMap> map;
    std::vector<BlockIndex> changed;  // since the copy before, ascending
    size_t bytes() const;             // that it does not share with the copy before, about
  };
  std::map<int64_t, Copy> copies_;  // by frames
};

}  // namespace vismap
