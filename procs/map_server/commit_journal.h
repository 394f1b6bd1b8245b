#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "wire/frame_key.h"

namespace vismap {

/// The frames that went into a map since it was saved the last time but one, in a text file beside
/// the saved map: one line "CAMERA UTIME" each. After a crash it tells which frames the saved map
/// lacks, also when the newest file turns out to be damaged and the one before it is used. Written
/// through to the system at every frame, so that it outlives the process, not a power cut.
class CommitJournal {
 public:
  /// No journal: nothing is written.
  CommitJournal() = default;
  /// Appends to the file, which is made when missing. Fails with path and reason, also when there
  /// is something else than a regular file.
  static Result<CommitJournal> Open(const std::filesystem::path& path);
  ~CommitJournal();
  CommitJournal(CommitJournal&& other) noexcept;
  CommitJournal& operator=(CommitJournal&& other) noexcept;

  /// False when the line could not be written (disk full).
  bool Add(const FrameKey& frame);
  /// How much was added so far, for MapWasSaved.
  size_t Mark() const { return dropped_ + unsaved_.size(); }
  /// The frames added up to `mark` are in a saved map: the file keeps only those since the save
  /// before.
  bool MapWasSaved(size_t mark);
  /// Frames are of another map from now on. The file keeps the others until the map is saved.
  void BeginMap() { DropUntil(Mark()); }

  /// The frames of a journal, oldest first. A last line that was cut short is left out; no file is
  /// no frames. Fails naming the file and the line that is not a frame.
  static Result<std::vector<FrameKey>> Read(const std::filesystem::path& path);

 private:
  explicit CommitJournal(int fd) : fd_(fd) {}
  bool Write(const std::string& lines) const;
  void DropUntil(size_t mark);

  int fd_ = -1;
  std::string unsaved_;  // the lines of the frames since the last save
  size_t dropped_ = 0;   // the length of all lines before these
};

}  // namespace vismap
