#pragma once

#include <string>
#include <vector>

#include "pictures/report.h"

namespace vismap {

/// What a log says of the processes and channels of a run, for a report.
struct LogSummary {
  std::vector<ReportProcess> processes;  ///< by source
  std::vector<ReportChannel> channels;   ///< by name
  int64_t unreadable = 0;                ///< STATUS messages that cannot be used
  int64_t left_out = 0;                  ///< messages of more than 256 channels or sources
};

/// Reads the whole log. Fails when it cannot be read.
Result<LogSummary> SummarizeLog(const std::string& path, const std::string& channel_prefix);

}  // namespace vismap
