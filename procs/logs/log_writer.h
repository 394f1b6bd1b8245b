#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>

#include "base/part_file.h"
#include "base/result.h"

namespace vismap {

/// Writes a log in the format of lcm-logger. The new log may replace one that is still
/// being read, and an interrupted program leaves no partial log, see PartFile.
class LogWriter {
 public:
  /// Fails, naming the file, when it cannot be created.
  static Result<LogWriter> Create(const std::filesystem::path& path);

  /// Appends an event; events are numbered from 0. `timestamp` [us since 1970]. `channel` has 1 to
  /// 63 characters.
  void Add(int64_t timestamp, const std::string& channel, std::span<const uint8_t> data);

  /// Gives the file its final name. Fails with the first write error.
  Result<void> Finish() { return file_.Finish(); }

  int64_t events() const { return events_; }

 private:
  explicit LogWriter(PartFile file) : file_(std::move(file)) {}

  PartFile file_;
  int64_t events_ = 0;
};

}  // namespace vismap
