#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/result.h"

namespace vismap {

// This room reads and writes logs of LCM messages in the format of lcm-logger, and presents
// recorded runs as sequences. A log is a list of events. An event consists of u32 0xeda1da01, i64
// event number, i64 time [us], i32 size of the channel name, i32 size of the data, name, data; all
// numbers are big-endian. LCM's own reader trusts the sizes and crashes on a damaged file, so this
// room has its own.

/// The first word of every event.
inline constexpr uint32_t kLogSyncWord = 0xeda1da01;

/// One recorded message: its head, and the position of its data in the file.
struct LogEvent {
  int64_t number = 0;
  int64_t timestamp = 0;  ///< time of recording [us since 1970]
  std::string channel;
  uint64_t offset = 0;       ///< of the event from the beginning of the file [bytes]
  uint64_t data_offset = 0;  ///< of its data from the beginning of the file [bytes]
  uint32_t data_size = 0;

  uint64_t end() const { return data_offset + data_size; }
};

/// A part of a log that is not a complete event.
struct LogDamage {
  uint64_t offset = 0;
  uint64_t bytes = 0;
  bool truncated = false;  ///< the file ends within an event, because the recorder was interrupted
};

using LogItem = std::variant<LogEvent, LogDamage>;

/// Reads a log of any size event by event; data is read only on request. All sizes in the file are
/// checked against the file size and the largest message. After a damaged part it continues with
/// the next complete event.
class LogReader {
 public:
  /// Fails, naming the path, when the file cannot be opened or is not a regular file. Data appended
  /// to the file later is not read. `channel_prefix` stands before the names of our channels in it.
  static Result<LogReader> Open(const std::filesystem::path& path,
                                const std::string& channel_prefix = "");
  ~LogReader();
  LogReader(LogReader&& other) noexcept;
  LogReader& operator=(LogReader&& other) noexcept;

  /// Returns the next event or damaged part; nullopt at the end. Fails when the file cannot be
  /// read.
  Result<std::optional<LogItem>> Next();

  /// Reads the data of an event, or the first `max_bytes` of it. Several threads may call it at
  /// once.
  Result<std::vector<uint8_t>> ReadData(const LogEvent& event, size_t max_bytes = SIZE_MAX) const;

  /// The name of our channel on which an event came, without the prefix; "" = it has not the
  /// prefix.
  std::string OwnChannel(const LogEvent& event) const;

  const std::string& channel_prefix() const { return channel_prefix_; }
  uint64_t size() const { return size_; }      ///< of the file [bytes]
  uint64_t position() const { return next_; }  ///< where Next continues [bytes]
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

  std::string path_, channel_prefix_;
  int fd_ = -1;
  uint64_t size_ = 0;
  uint64_t next_ = 0;
};

/// Calls `on_event(const LogEvent&)`, which returns Result<void>, for every remaining event of the
/// log, and `on_damage(const LogDamage&)` for every damaged part. Stops at the first error.
template <typename OnEvent, typename OnDamage>
Result<void> ForEachEvent(LogReader& reader, const OnEvent& on_event, const OnDamage& on_damage) {
  while (true) {
    const Result<std::optional<LogItem>> item = reader.Next();
    if (!item) return tl::unexpected(item.error());
    if (!*item) return {};
    if (const LogDamage* damage = std::get_if<LogDamage>(&**item)) {
      on_damage(*damage);
    } else if (const Result<void> handled = on_event(std::get<LogEvent>(**item)); !handled) {
      return handled;
    }
  }
}

}  // namespace vismap
