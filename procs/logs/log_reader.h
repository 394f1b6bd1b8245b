#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/result.h"

namespace vismap {

// What lives in this room: logs of LCM messages as lcm-logger writes them and lcm-logplayer reads
// them, and recorded runs seen as sequences. A log is a row of events; numbers are big-endian:
// u32 0xeda1da01, i64 event number, i64 time [us], i32 size of the channel's name, i32 size of the
// data, name, data. LCM's own reader trusts the sizes and crashes on a damaged file.

/// First word of every event.
inline constexpr uint32_t kLogSyncWord = 0xeda1da01;
/// Longest name of a channel that LCM sends [bytes].
inline constexpr size_t kMaxChannelName = 63;

/// One recorded message: what its head says, and where its data lie in the file.
struct LogEvent {
  int64_t number = 0;
  int64_t timestamp = 0;  ///< when it was recorded [us since 1970]
  std::string channel;
  uint64_t offset = 0;  ///< of the event in the file [bytes]
  uint64_t data_offset = 0;
  uint32_t data_size = 0;

  uint64_t end() const { return data_offset + data_size; }
};

/// Bytes of a log that are no event.
struct LogDamage {
  uint64_t offset = 0;
  uint64_t bytes = 0;
  bool truncated = false;  ///< an event that the file ends within: its recorder was cut off
};

using LogItem = std::variant<LogEvent, LogDamage>;

/// Goes through a log of any size, head by head; data are read when asked for. Nothing in the file
/// is trusted: sizes are checked against the file and against what travels on a bus, and after
/// damage it goes on with the next event that can be found.
class LogReader {
 public:
  /// Fails naming the path when it cannot be opened or is no regular file. What is written to the
  /// file later is not seen.
  static Result<LogReader> Open(const std::filesystem::path& path);
  ~LogReader();
  LogReader(LogReader&& other) noexcept;
  LogReader& operator=(LogReader&& other) noexcept;

  /// The next event or damage; none at the end. Fails when the file cannot be read.
  Result<std::optional<LogItem>> Next();

  /// The data of an event, or their first `max_bytes`. May be called from several threads at once.
  Result<std::vector<uint8_t>> ReadData(const LogEvent& event, size_t max_bytes = SIZE_MAX) const;

  uint64_t size() const { return size_; }      ///< of the file [bytes]
  uint64_t position() const { return next_; }  ///< how far Next has come [bytes]
  const std::string& path() const { return path_; }

 private:
  struct Head {
    enum class State { kWhole, kPastEnd, kNone } state = State::kNone;
    LogEvent event;
  };
  LogReader(std::string path, int fd, uint64_t size)
      : path_(std::move(path)), fd_(fd), size_(size) {}
  Result<std::vector<uint8_t>> ReadAt(uint64_t offset, uint64_t bytes) const;
  Result<Head> HeadAt(uint64_t offset) const;
  Result<bool> MayBeginAt(uint64_t offset) const;
  Result<std::optional<uint64_t>> FindEvent(uint64_t from) const;
  Result<std::optional<LogItem>> AcceptEvent(LogEvent event);
  Result<std::optional<LogItem>> SkipDamage(uint64_t search_from, bool may_be_truncated);

  std::string path_;
  int fd_ = -1;
  uint64_t size_ = 0;
  uint64_t next_ = 0;
};

/// Calls `take(const LogEvent&)`, which returns Result<void>, for every event of the log from its
/// beginning, and `damage(const LogDamage&)` for the rest. Ends at the first failure.
template <typename Take, typename Damage>
Result<void> ForEachEvent(LogReader& reader, const Take& take, const Damage& damage) {
  while (true) {
    const Result<std::optional<LogItem>> item = reader.Next();
    if (!item) return tl::unexpected(item.error());
    if (!*item) return {};
    if (const LogDamage* bad = std::get_if<LogDamage>(&**item)) {
      damage(*bad);
    } else if (const Result<void> taken = take(std::get<LogEvent>(**item)); !taken) {
      return taken;
    }
  }
}

}  // namespace vismap
