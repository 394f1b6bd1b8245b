#include "map_server/commit_journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>

#include "base/file.h"

namespace vismap {

Result<CommitJournal> CommitJournal::Open(const std::filesystem::path& path) {
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd < 0) return Fail(path.string() + ": cannot open the journal: " + std::strerror(errno));
  return CommitJournal(fd);
}

CommitJournal::~CommitJournal() {
  if (fd_ >= 0) close(fd_);
}

CommitJournal::CommitJournal(CommitJournal&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

CommitJournal& CommitJournal::operator=(CommitJournal&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

bool CommitJournal::Add(const FrameKey& frame) {
  if (fd_ < 0) return true;
  const std::string line =
      std::to_string(Raw(frame.camera_id)) + " " + std::to_string(frame.utime) + "\n";
  return write(fd_, line.data(), line.size()) == static_cast<ssize_t>(line.size());
}

bool CommitJournal::Restart() { return fd_ < 0 || ftruncate(fd_, 0) == 0; }

Result<std::vector<FrameKey>> CommitJournal::Read(const std::filesystem::path& path) {
  std::vector<FrameKey> frames;
  if (!std::filesystem::exists(path)) return frames;
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  std::istringstream text(std::string(bytes->begin(), bytes->end()));
  for (std::string line; std::getline(text, line);) {
    if (text.eof()) break;  // without its end of line: cut short
    int32_t camera = 0;
    int64_t utime = 0;
    std::istringstream fields(line);
    if (!(fields >> camera >> utime) || !(fields >> std::ws).eof()) {
      return Fail(path.string() + ", line " + std::to_string(frames.size() + 1) +
                  ": expected CAMERA UTIME, found '" + line + "'");
    }
    frames.push_back({CameraId{camera}, utime});
  }
  return frames;
}

}  // namespace vismap
