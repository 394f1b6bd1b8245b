#include "viewer/spill_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace vismap {
namespace {

std::string SpillFolder(const std::string& folder) {
  if (!folder.empty()) return folder;
  const char* temporary = std::getenv("TMPDIR");
  return temporary != nullptr && *temporary != '\0' ? temporary : "/var/tmp";
}

Result<void> WriteAt(int fd, std::span<const uint8_t> bytes, uint32_t offset,
                     const std::string& folder) {
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t wrote = pwrite(fd, bytes.data() + done, bytes.size() - done,
                                 static_cast<off_t>(offset) + static_cast<off_t>(done));
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0)
      return Fail("cannot write to a temporary file in " + folder + ": " + std::strerror(errno));
    done += static_cast<size_t>(wrote);
  }
  return {};
}

}  // namespace

Result<SpillFile> SpillFile::Open(const std::string& folder) {
  SpillFile file(SpillFolder(folder));
  if (const Result<void> begun = file.BeginPart(); !begun) return tl::unexpected(begun.error());
  return file;
}

SpillFile::SpillFile(SpillFile&& other) noexcept
    : folder_(std::move(other.folder_)),
      parts_(std::exchange(other.parts_, {})),
      next_(other.next_),
      closed_(other.closed_) {}

SpillFile& SpillFile::operator=(SpillFile&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(parts_, other.parts_);
  std::swap(next_, other.next_);
  std::swap(closed_, other.closed_);
  return *this;
}

SpillFile::~SpillFile() {
  for (const auto& entry : parts_) close(entry.second.fd);
}

Result<void> SpillFile::BeginPart() {
  std::string path = folder_ + "/vismap-viewer-XXXXXX";
  const int fd = mkostemp(path.data(), O_CLOEXEC);
  if (fd < 0)
    return Fail("cannot create a temporary file in " + folder_ + ": " + std::strerror(errno));
  unlink(path.c_str());
  parts_[next_++] = {fd, 0};
  closed_ = false;
  return {};
}

Result<SpillFile::Place> SpillFile::Append(std::span<const uint8_t> bytes) {
  if (bytes.empty()) return Place{};
  if (closed_ || parts_.empty() || parts_.rbegin()->second.size >= kPartBytes) {
    if (const Result<void> begun = BeginPart(); !begun) return tl::unexpected(begun.error());
  }
  auto& [number, part] = *parts_.rbegin();
  if (const auto written = WriteAt(part.fd, bytes, part.size, folder_); !written)
    return tl::unexpected(written.error());
  const Place place{number, part.size, static_cast<uint32_t>(bytes.size())};
  part.size += place.size;
  return place;
}

Result<std::vector<uint8_t>> SpillFile::Read(Place place) const {
  std::vector<uint8_t> bytes(place.size);
  if (bytes.empty()) return bytes;
  const auto found = parts_.find(place.part);
  if (found == parts_.end()) return Fail("a part of the temporary file is gone");
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = pread(found->second.fd, bytes.data() + done, bytes.size() - done,
                              static_cast<off_t>(place.offset) + static_cast<off_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      return Fail("cannot read from a temporary file in " + folder_ + ": " +
                  (got < 0 ? std::strerror(errno) : "it is too short"));
    done += static_cast<size_t>(got);
  }
  return bytes;
}

std::vector<uint32_t> SpillFile::CloseParts() {
  closed_ = true;
  std::vector<uint32_t> numbers;
  for (const auto& entry : parts_) numbers.push_back(entry.first);
  return numbers;
}

void SpillFile::Drop(uint32_t part) {
  const auto found = parts_.find(part);
  if (found == parts_.end()) return;
  close(found->second.fd);
  parts_.erase(found);
}

uint64_t SpillFile::bytes() const {
  uint64_t total = 0;
  for (const auto& entry : parts_) total += entry.second.size;
  return total;
}

}  // namespace vismap
