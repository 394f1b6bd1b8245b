#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "logs/log_reader.h"

namespace vismap {

/// What of a log to keep.
struct CutOptions {
  double from = 0;                 ///< from so many seconds after the log's first event on
  std::optional<double> to;        ///< up to before this time [s]; none = to the end
  std::set<std::string> channels;  ///< names; empty = all
};

struct CutResult {
  int64_t kept = 0, left_out = 0;
  uint64_t damaged_bytes = 0;  ///< of the log, not in the cut
};

/// Copies events with their times, byte for byte; they are numbered anew. `out` may be the log
/// itself. Fails when the log cannot be read, nothing is kept, or `out` cannot be written.
Result<CutResult> CutLog(LogReader& reader, const CutOptions& options,
                         const std::filesystem::path& out);

}  // namespace vismap
