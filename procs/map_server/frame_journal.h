#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>
#include <vismap/segmented_frame_t.hpp>

#include "base/result.h"
#include "map_server/journal_records.h"

namespace vismap {

struct FrameJournalLimits {
  uint64_t max_bytes = uint64_t{1} << 30;  ///< on disk; beyond, the oldest file is dropped
  uint64_t file_bytes = uint64_t{64} << 20;
  size_t waiting_bytes = size_t{256} << 20;  ///< in memory, until the disk has them
};

/// The frames that went into a map, in their order, as they came, in files of a folder; and the
/// poses that were corrected later. So the map can be made again. A thread of its own writes them,
/// through to the system, so that they outlive the process, not a power cut. A frame that the disk
/// does not take is lost, see trouble().
///
/// The frame with which the map got revision r is called frame r. When the map goes on from an
/// older state and gets another frame r, the journal forgets the frames from r on that it had.
class FrameJournal {
 public:
  /// Reads what the folder has; it is made when missing. What is damaged there is left out and
  /// named in remarks(). Fails when the folder or a file in it cannot be read or made.
  static Result<std::unique_ptr<FrameJournal>> Open(const std::filesystem::path& folder,
                                                    const FrameJournalLimits& limits);
  /// Writes what waits.
  ~FrameJournal();
  FrameJournal(const FrameJournal&) = delete;
  FrameJournal& operator=(const FrameJournal&) = delete;

  /// Frames are of another map from now on: the files are removed.
  void BeginMap();
  /// The same, but the folder gets another name, which is returned.
  Result<std::filesystem::path> BeginMapAside();

  /// Adds a frame. The message is encoded and written later.
  void Add(JournaledFrame frame, segmented_frame_t message);
  /// Frames that the journal has get these poses. Waits until the disk has them, or fails and
  /// changes nothing.
  Result<void> AddPoses(std::vector<JournaledPose> poses);

  /// The frames with their newest poses, by revision.
  std::vector<JournaledFrame> Frames() const;
  /// The message of frame `revision`, with the pose that it came with. Any thread may call it.
  /// Waits until the disk has the frame.
  Result<segmented_frame_t> Read(int64_t revision) const;

  /// Whether any of the frames has another pose than it came with.
  bool has_corrections() const;
  /// What was found at the start: whole sentences.
  const std::vector<std::string>& remarks() const { return remarks_; }
  /// Says from which frame on the journal is incomplete, and why.
  std::optional<std::string> trouble() const;
  uint64_t bytes() const;
  size_t size() const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  struct Entry {
    JournaledFrame frame;
    uint64_t file = 0;    // number
    uint64_t offset = 0;  // of the record
    uint64_t bytes = 0;   // 0 = not on disk yet
  };
  struct Task {
    std::optional<JournaledFrame> frame;
    segmented_frame_t message{};
    std::vector<JournaledPose> poses;
    size_t bytes = 0;
    uint64_t number = 0;
  };

  FrameJournal(std::filesystem::path folder, const FrameJournalLimits& limits)
      : folder_(std::move(folder)), limits_(limits) {}
  Result<void> ReadFiles();
  void Index(uint64_t file, std::span<const uint8_t> bytes, const std::string& name);
  void SetPoses(std::span<const JournaledPose> poses);
  void Enter(Entry entry);
  std::filesystem::path PathOf(uint64_t file) const;
  void WaitUntilWritten(std::unique_lock<std::mutex>* lock) const;
  void Forget();
  void Run();
  Result<void> Write(Task* task);
  Result<void> Append(std::span<const uint8_t> record);
  Result<void> NextFile();
  void DropOldest();
  void Lose(const JournaledFrame& frame, const std::string& reason);

  std::filesystem::path folder_;
  FrameJournalLimits limits_;
  std::vector<std::string> remarks_;

  mutable std::mutex mutex_;  // protects what follows
  mutable std::condition_variable changed_;
  std::map<int64_t, Entry> entries_;  // by revision
  std::map<FrameKey, int64_t> revisions_;
  std::map<uint64_t, uint64_t> files_;  // size by number
  std::deque<Task> waiting_;
  size_t waiting_bytes_ = 0;
  uint64_t last_task_ = 0, done_tasks_ = 0;
  std::optional<Error> poses_error_;  // of the last AddPoses
  std::optional<std::string> trouble_;
  bool has_corrections_ = false, ends_ = false;

  int fd_ = -1;  // of the newest file; of the thread alone while it has work
  std::thread thread_;
};

}  // namespace vismap
