#include "base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <functional>
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

std::filesystem::path FolderOf(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

// Flushes the folder of a file: only then a rename is on disk.
Result<void> SyncFolder(const std::filesystem::path& path) {
  const std::filesystem::path folder = FolderOf(path);
  const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.get() < 0) return SystemFault(folder, "open the folder");
  // EINVAL: the file system cannot flush folders; nothing more can be done there.
  if (::fsync(directory.get()) != 0 && errno != EINVAL) return SystemFault(folder, "flush");
  return {};
}

// Gives a regular file one more name, which replaces what had it. Where the file system has no
// links, the file is copied. Does nothing when there is no such file.
Result<void> KeepAs(const std::filesystem::path& path, const std::filesystem::path& name) {
  if (!PermissionsOf(path)) return {};
  const std::filesystem::path temporary = TemporaryName(name);
  std::error_code error;
  if (::link(path.c_str(), temporary.c_str()) != 0 &&
      !std::filesystem::copy_file(path, temporary, error)) {
    return Fail(path.string() + ": cannot keep it as " + name.string() + ": " + error.message());
  }
  if (::rename(temporary.c_str(), name.c_str()) == 0) {
    ::unlink(temporary.c_str());  // rename leaves it when both were names of one file already
    return {};
  }
  auto fault = SystemFault(name, "replace the file");
  ::unlink(temporary.c_str());
  return fault;
}

Result<void> Replace(const std::filesystem::path& path, const std::filesystem::path& temporary,
                     const std::vector<std::filesystem::path>& keep_as) {
  for (const std::filesystem::path& name : keep_as) {
    if (Result<void> kept = KeepAs(path, name); !kept) return kept;
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) return SystemFault(path, "replace the file");
  return {};
}

// The process that made a temporary file (see TemporaryName) and the name of the file that it was
// for; nullopt when the name is none of a temporary file.
struct Temporary {
  pid_t process;
  std::string target;
};
std::optional<Temporary> ParseTemporary(const std::string& name) {
  const auto digits = [](const std::string& text) {
    return !text.empty() && text.size() <= 9 &&
           text.find_first_not_of("0123456789") == std::string::npos;
  };
  const size_t mark = name.rfind(".tmp-"), dash = name.rfind('-');
  if (mark == std::string::npos || dash < mark + 5) return std::nullopt;
  const std::string process = name.substr(mark + 5, dash - mark - 5);
  if (!digits(process) || !digits(name.substr(dash + 1))) return std::nullopt;
  return Temporary{std::stoi(process), name.substr(0, mark)};
}

bool IsRunning(pid_t process) {
  return process != ::getpid() && (::kill(process, 0) == 0 || errno != ESRCH);
}

int RemoveTemporaries(const std::filesystem::path& folder,
                      const std::function<bool(const std::string& target)>& ours) {
  int removed = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const auto temporary = ParseTemporary(entry.path().filename().string());
    if (!temporary || !ours(temporary->target) || IsRunning(temporary->process)) continue;
    if (!std::filesystem::is_regular_file(entry.symlink_status(error))) continue;
    if (::unlink(entry.path().c_str()) == 0) ++removed;
  }
  return removed;
}

}  // namespace

Result<void> WriteFileAtomically(const std::filesystem::path& path,
                                 std::span<const uint8_t> bytes) {
  return WriteFileAndKeepOld(path, bytes, {});
}

Result<void> WriteFileAndKeepOld(const std::filesystem::path& path, std::span<const uint8_t> bytes,
                                 const std::vector<std::filesystem::path>& keep_as) {
  const std::filesystem::path temporary = TemporaryName(path);
  Result<void> done = WriteAndSync(temporary, bytes, PermissionsOf(path));
  if (done) done = Replace(path, temporary, keep_as);
  if (!done) {
    ::unlink(temporary.c_str());
    return done;
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

Result<std::filesystem::path> SetAside(const std::filesystem::path& path,
                                       const std::string& ending) {
  std::filesystem::path name;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return Fail(path.string() + ": expected a regular file");
  int number = 0;
  do {
    name = path.string() + "." + ending + "-" + std::to_string(++number);
  } while (std::filesystem::symlink_status(name, error).type() !=
           std::filesystem::file_type::not_found);
  if (::rename(path.c_str(), name.c_str()) != 0)
    return SystemFault(path, "give the file another name");
  return name;
}

int RemoveStaleTemporaries(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  return RemoveTemporaries(FolderOf(path),
                           [&](const std::string& target) { return target == name; });
}

int RemoveStaleTemporariesIn(const std::filesystem::path& folder, const std::string& part) {
  return RemoveTemporaries(
      folder, [&](const std::string& target) { return target.find(part) != std::string::npos; });
}

Result<void> CheckIsNotInput(const std::filesystem::path& input, const std::filesystem::path& out) {
  std::error_code none;
  if (std::filesystem::equivalent(input, out, none))
    return Fail(out.string() + ": this is the input itself; name another file");
  return {};
}

Result<void> CreateFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Fail("cannot create the folder " + folder.string() + ": " + error.message());
  return {};
}

}  // namespace vismap
