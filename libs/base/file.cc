#include "base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <string>
#include <system_error>

namespace vismap {
namespace {

// Closes a file descriptor at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  bool Close() {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

 private:
  int fd_;
};

tl::unexpected<Error> SystemFault(const std::filesystem::path& path, const char* step) {
  const int code = errno;
  return Fail(path.string() + ": cannot " + step + ": " + std::strerror(code) + " (errno " +
              std::to_string(code) + ")");
}

// A name in the same folder, since rename does not work across file systems; unique per process and
// call.
std::filesystem::path TemporaryName(const std::filesystem::path& path) {
  static std::atomic<uint32_t> counter{0};
  return path.string() + ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
}

bool WriteAll(int fd, std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  return true;
}

// The permissions of the file that will be replaced; nullopt when there is none, or no regular one.
std::optional<mode_t> PermissionsOf(const std::filesystem::path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return status.st_mode & 0777;
}

Result<void> WriteAndSync(const std::filesystem::path& path, std::span<const uint8_t> bytes,
                          std::optional<mode_t> permissions) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (file.get() < 0) return SystemFault(path, "create the file");
  if (permissions && ::fchmod(file.get(), *permissions) != 0)
    return SystemFault(path, "set the permissions");
  if (!WriteAll(file.get(), bytes)) return SystemFault(path, "write");
  if (::fsync(file.get()) != 0) return SystemFault(path, "flush to disk");
  if (!file.Close()) return SystemFault(path, "close");
  return {};
}

// Flushes the folder of a file: only then a rename is on disk.
Result<void> SyncFolder(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.get() < 0) return SystemFault(folder, "open the folder");
  // EINVAL: the file system cannot flush folders; nothing more can be done there.
  if (::fsync(directory.get()) != 0 && errno != EINVAL) return SystemFault(folder, "flush");
  return {};
}

}  // namespace

Result<void> WriteFileAtomically(const std::filesystem::path& path,
                                 std::span<const uint8_t> bytes) {
  const std::filesystem::path temporary = TemporaryName(path);
  if (Result<void> written = WriteAndSync(temporary, bytes, PermissionsOf(path)); !written) {
    ::unlink(temporary.c_str());
    return written;
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    auto fault = SystemFault(path, "replace the file");
    ::unlink(temporary.c_str());
    return fault;
  }
  return SyncFolder(path);
}

Result<void> WriteFileAtomically(const std::filesystem::path& path, std::string_view text) {
  return WriteFileAtomically(path,
                             std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

Result<std::vector<uint8_t>> ReadFileBytes(const std::filesystem::path& path, uint64_t max_bytes) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) return SystemFault(path, "open");
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) return SystemFault(path, "read the size");
  if (!S_ISREG(status.st_mode)) return Fail(path.string() + ": expected a regular file");
  const auto size = static_cast<uint64_t>(status.st_size);
  if (size > max_bytes) {
    return Fail(path.string() + ": expected at most " + std::to_string(max_bytes) +
                " bytes, found " + std::to_string(size));
  }
  std::vector<uint8_t> bytes(size);
  size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t got = ::read(file.get(), bytes.data() + filled, bytes.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return SystemFault(path, "read");
    if (got == 0) break;  // the file shrank meanwhile
    filled += static_cast<size_t>(got);
  }
  bytes.resize(filled);
  return bytes;
}

int RemoveStaleTemporaries(const std::filesystem::path& path) {
  const std::string prefix = path.filename().string() + ".tmp-";
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  int removed = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    const std::string rest = name.substr(prefix.size());  // PID-COUNTER
    const size_t digits = rest.find_first_not_of("0123456789");
    if (digits == 0 || digits == std::string::npos || rest[digits] != '-' || digits > 9) continue;
    const pid_t pid = std::stoi(rest.substr(0, digits));
    const bool alive = pid != ::getpid() && (::kill(pid, 0) == 0 || errno != ESRCH);
    if (alive || !entry.is_regular_file(error)) continue;
    if (::unlink(entry.path().c_str()) == 0) ++removed;
  }
  return removed;
}

Result<void> CreateFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Fail("cannot create the folder " + folder.string() + ": " + error.message());
  return {};
}

}  // namespace vismap
