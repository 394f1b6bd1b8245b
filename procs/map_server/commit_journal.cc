#include "map_server/commit_journal.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>

#include "base/file.h"
#include "base/printable.h"

namespace vismap {

namespace {
constexpr uint64_t kMaxBytes = uint64_t{256} << 20;  // of a journal: ten million frames
constexpr size_t kMaxUnsaved = size_t{16} << 20;     // [bytes] in memory
}  // namespace

Result<CommitJournal> CommitJournal::Open(const std::filesystem::path& path) {
  // O_NONBLOCK: a pipe is not waited for.
  const int flags = O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK;
  const int fd = open(path.c_str(), flags, 0644);
  if (fd < 0) return Fail(path.string() + ": cannot open the journal: " + std::strerror(errno));
  CommitJournal journal(fd);
  struct stat status {};
  if (fstat(fd, &status) != 0 || !S_ISREG(status.st_mode))
    return Fail(path.string() + ": expected a regular file for the journal");
  return journal;
}

CommitJournal::~CommitJournal() {
  if (fd_ >= 0) close(fd_);
}

CommitJournal::CommitJournal(CommitJournal&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      unsaved_(std::move(other.unsaved_)),
      dropped_(other.dropped_) {}

CommitJournal& CommitJournal::operator=(CommitJournal&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(unsaved_, other.unsaved_);
  std::swap(dropped_, other.dropped_);
  return *this;
}

bool CommitJournal::Add(const FrameKey& frame) {
  if (fd_ < 0) return true;
  const std::string line =
      std::to_string(Raw(frame.camera_id)) + " " + std::to_string(frame.utime) + "\n";
  if (unsaved_.size() < kMaxUnsaved) unsaved_ += line;
  return Write(line);
}

bool CommitJournal::Write(const std::string& lines) const {
  return write(fd_, lines.data(), lines.size()) == static_cast<ssize_t>(lines.size());
}

void CommitJournal::DropUntil(size_t mark) {
  const size_t length = std::min(mark - std::min(mark, dropped_), unsaved_.size());
  unsaved_.erase(0, length);
  dropped_ += length;
}

bool CommitJournal::MapWasSaved(size_t mark) {
  const std::string lines = unsaved_;
  DropUntil(mark);
  return fd_ < 0 || (ftruncate(fd_, 0) == 0 && Write(lines));
}

Result<std::vector<FrameKey>> CommitJournal::Read(const std::filesystem::path& path) {
  std::vector<FrameKey> frames;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return frames;
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, kMaxBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  std::istringstream text(std::string(bytes->begin(), bytes->end()));
  for (std::string line; std::getline(text, line);) {
    if (text.eof()) break;  // without its end of line: cut short
    int32_t camera = 0;
    int64_t utime = 0;
    std::istringstream fields(line);
    if (!(fields >> camera >> utime) || !(fields >> std::ws).eof()) {
      return Fail(path.string() + ", line " + std::to_string(frames.size() + 1) +
                  ": expected CAMERA UTIME, found '" + PrintableText(line, 100) + "'");
    }
    frames.push_back({CameraId{camera}, utime});
  }
  return frames;
}

}  // namespace vismap
