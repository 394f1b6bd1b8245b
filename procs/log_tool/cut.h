#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "logs/log_reader.h"

namespace vismap {

/// The part of a log to keep.
struct CutOptions {
  double from = 0;  ///< begin, relative to the first event of the log [s]
  /// End (exclusive), relative to the first event [s]; nullopt = end of the log.
  std::optional<double> to;
  std::set<std::string> channels;  ///< channels to keep; empty = all
};

/// Whether `options` keep an event; `own` = the name of our channel without its prefix, `start` =
/// the time of the first event of the log [us].
bool Keeps(const CutOptions& options, const LogEvent& event, const std::string& own, int64_t start);

struct CutResult {
  int64_t kept = 0, left_out = 0;
  uint64_t damaged_bytes = 0;  ///< damaged part of the log, which is not copied
};

/// Copies events with their times, byte for byte, and renumbers them. `out` may be the log itself.
/// Fails when the log cannot be read, when no event is kept, or when `out` cannot be written.
Result<CutResult> CutLog(LogReader& reader, const CutOptions& options,
                         const std::filesystem::path& out);

}  // namespace vismap
