#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "base/result.h"

namespace vismap {

/// Writes a log in the format of lcm-logger. The file gets its final name only in Finish. So the
/// new log may replace a log that is still being read, and an interrupted program leaves no partial
/// log.
class LogWriter {
 public:
  /// Fails, naming the file, when it cannot be created.
  static Result<LogWriter> Create(const std::filesystem::path& path);
  ~LogWriter();
  LogWriter(LogWriter&&) = default;
  LogWriter& operator=(LogWriter&&) = delete;

  /// Appends an event; events are numbered from 0. `timestamp` [us since 1970]. `channel` has 1 to
  /// 63 characters.
  void Add(int64_t timestamp, const std::string& channel, std::span<const uint8_t> data);

  /// Gives the file its final name. Fails with the first write error.
  Result<void> Finish();

  int64_t events() const { return events_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;
  LogWriter(std::filesystem::path path, File file)
      : path_(std::move(path)), file_(std::move(file)) {}
  static std::filesystem::path PartOf(const std::filesystem::path& path) {
    return path.string() + ".part";
  }

  std::filesystem::path path_;
  File file_;
  int64_t events_ = 0;
  int error_ = 0;  // errno of the first write that failed
};

}  // namespace vismap
