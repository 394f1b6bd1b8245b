#include "logs/log_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

#include "wire/channels.h"

namespace vismap {
namespace {

constexpr size_t kHeadBytes = 28;
constexpr uint64_t kFirstSearch = 4096, kLargestSearch = uint64_t{1} << 20;
constexpr std::array<uint8_t, 4> kSync{0xed, 0xa1, 0xda, 0x01};

uint64_t BigEndian(std::span<const uint8_t> bytes) {
  uint64_t value = 0;
  for (const uint8_t byte : bytes) value = (value << 8) | byte;
  return value;
}

// LCM sends any name; those that people give have no control characters.
bool IsChannelName(std::span<const uint8_t> name) {
  return std::all_of(name.begin(), name.end(), [](uint8_t c) { return c >= 32 && c != 127; });
}

}  // namespace

Result<LogReader> LogReader::Open(const std::filesystem::path& path,
                                  const std::string& channel_prefix) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC |
                                        O_NONBLOCK);  // O_NONBLOCK: opening a pipe must not block
  if (fd < 0) return Fail(path.string() + ": cannot open the log: " + std::strerror(errno));
  LogReader reader(path.string(), fd, 0);
  reader.channel_prefix_ = channel_prefix;
  struct stat info {};
  if (fstat(fd, &info) != 0 || !S_ISREG(info.st_mode))
    return Fail(path.string() + ": expected a log, but this is not a regular file");
  reader.size_ = static_cast<uint64_t>(info.st_size);
  return reader;
}

LogReader::~LogReader() {
  if (fd_ >= 0) close(fd_);
}

LogReader::LogReader(LogReader&& other) noexcept
    : path_(std::move(other.path_)),
      channel_prefix_(std::move(other.channel_prefix_)),
      fd_(std::exchange(other.fd_, -1)),
      size_(other.size_),
      next_(other.next_) {}

LogReader& LogReader::operator=(LogReader&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(channel_prefix_, other.channel_prefix_);
  std::swap(fd_, other.fd_);
  std::swap(size_, other.size_);
  std::swap(next_, other.next_);
  return *this;
}

// Returns fewer bytes only when the file ends before.
Result<std::vector<uint8_t>> LogReader::ReadAt(uint64_t offset, uint64_t bytes) const {
  std::vector<uint8_t> data(std::min(bytes, size_ - std::min(offset, size_)));
  size_t have = 0;
  while (have < data.size()) {
    const ssize_t got =
        pread(fd_, data.data() + have, data.size() - have, static_cast<off_t>(offset + have));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      return Fail(path_ + ": cannot read at byte " + std::to_string(offset + have) + ": " +
                  (got < 0 ? std::strerror(errno) : "the file was truncated meanwhile"));
    }
    have += static_cast<size_t>(got);
  }
  return data;
}

Result<LogReader::Head> LogReader::HeadAt(uint64_t offset) const {
  const Result<std::vector<uint8_t>> read = ReadAt(offset, kHeadBytes + kMaxChannelName);
  if (!read) return tl::unexpected(read.error());
  const std::span<const uint8_t> bytes(*read);
  Head head;
  const size_t sync = std::min(bytes.size(), kSync.size());
  if (!std::equal(kSync.begin(), kSync.begin() + static_cast<std::ptrdiff_t>(sync), bytes.begin()))
    return head;                    // no event begins here
  if (bytes.size() < kHeadBytes) {  // the file ends within the head
    head.state = Head::State::kPastEnd;
    return head;
  }
  const uint64_t name_size = BigEndian(bytes.subspan(20, 4));
  const uint64_t data_size = BigEndian(bytes.subspan(24, 4));
  // Impossible sizes: the sync word is part of other data.
  if (name_size < 1 || name_size > kMaxChannelName || data_size > kMaxMessageBytes) return head;
  const auto name = bytes.subspan(kHeadBytes, std::min(name_size, bytes.size() - kHeadBytes));
  if (!IsChannelName(name)) return head;
  head.event = {static_cast<int64_t>(BigEndian(bytes.subspan(4, 8))),
                static_cast<int64_t>(BigEndian(bytes.subspan(12, 8))),
                std::string(name.begin(), name.end()),
                offset,
                offset + kHeadBytes + name_size,
                static_cast<uint32_t>(data_size)};
  head.state = head.event.end() <= size_ ? Head::State::kWhole : Head::State::kPastEnd;
  return head;
}

// Whether an event, the beginning of a truncated event, or the end of the file is at this offset.
Result<bool> LogReader::MayBeginAt(uint64_t offset) const {
  const Result<std::vector<uint8_t>> bytes = ReadAt(offset, kSync.size());
  if (!bytes) return tl::unexpected(bytes.error());
  return std::equal(bytes->begin(), bytes->end(), kSync.begin());
}

// Returns the offset of the first complete event at or after `from`.
Result<std::optional<uint64_t>> LogReader::FindEvent(uint64_t from) const {
  // The next event is usually near, so start with a small step: otherwise a malicious file could
  // make every event cost a long read.
  for (uint64_t step = kFirstSearch; from < size_; step = std::min(2 * step, kLargestSearch)) {
    const Result<std::vector<uint8_t>> bytes = ReadAt(from, step);
    if (!bytes) return tl::unexpected(bytes.error());
    auto at = bytes->begin();
    while ((at = std::search(at, bytes->end(), kSync.begin(), kSync.end())) != bytes->end()) {
      const uint64_t offset = from + static_cast<uint64_t>(at - bytes->begin());
      const Result<Head> head = HeadAt(offset);
      if (!head) return tl::unexpected(head.error());
      if (head->state == Head::State::kWhole) return offset;
      ++at;
    }
    if (bytes->size() < step) break;
    from += step - (kSync.size() - 1);  // a sync word may span two steps
  }
  return std::nullopt;
}

Result<std::optional<LogItem>> LogReader::Next() {
  if (next_ >= size_) return std::optional<LogItem>();
  Result<Head> head = HeadAt(next_);
  if (!head) return tl::unexpected(head.error());
  if (head->state == Head::State::kWhole) return AcceptEvent(std::move(head->event));
  return SkipDamage(next_ + 1, head->state == Head::State::kPastEnd);
}

// The next event should begin where this one ends. If it does not, one of the two is damaged. It is
// this one if another complete event lies within its data.
Result<std::optional<LogItem>> LogReader::AcceptEvent(LogEvent event) {
  const Result<bool> fits = MayBeginAt(event.end());
  if (!fits) return tl::unexpected(fits.error());
  if (!*fits) {
    const Result<std::optional<uint64_t>> within = FindEvent(event.data_offset);
    if (!within) return tl::unexpected(within.error());
    if (*within && **within < event.end()) return SkipDamage(**within, false);
  }
  next_ = event.end();
  return LogItem(std::move(event));
}

Result<std::optional<LogItem>> LogReader::SkipDamage(uint64_t search_from, bool may_be_truncated) {
  const Result<std::optional<uint64_t>> found = FindEvent(search_from);
  if (!found) return tl::unexpected(found.error());
  const uint64_t end = found->value_or(size_);
  const LogDamage damage{next_, end - next_, may_be_truncated && !*found};
  next_ = end;
  return LogItem(damage);
}

std::string LogReader::OwnChannel(const LogEvent& event) const {
  return WithoutPrefix(event.channel, channel_prefix_).value_or("");
}

Result<std::vector<uint8_t>> LogReader::ReadData(const LogEvent& event, size_t max_bytes) const {
  return ReadAt(event.data_offset, std::min<uint64_t>(event.data_size, max_bytes));
}

}  // namespace vismap
