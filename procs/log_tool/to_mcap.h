#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/reason_counts.h"
#include "config/process_options.h"
#include "log_tool/cut.h"
#include "logs/log_reader.h"
#include "mcap/map_topics.h"
#include "runtime/stop_signal.h"

namespace vismap {

/// What of a log becomes an MCAP file, and how.
struct McapExportOptions {
  CutOptions cut;  ///< the map is followed from the beginning of the log, whatever its `from`
  MapTopicOptions map;
};

struct McapExport {
  std::map<std::string, int64_t> topics;  ///< number of messages of each topic
  uint64_t bytes = 0;                     ///< of the file
  /// Messages for which Foxglove has no counterpart, by channel.
  std::map<std::string, int64_t> without_counterpart;
  /// Octrees whose content is in /map/occupied and /map/free, by channel.
  std::map<std::string, int64_t> other_octrees;
  int64_t repeated = 0;              ///< frames, grids and trees that were sent again
  ReasonCounts unusable;             ///< messages that cannot be decoded, or not followed
  uint64_t damaged_bytes = 0;        ///< damaged part of the log
  std::vector<std::string> remarks;  ///< sentences
};

/// Writes the messages of a log as an MCAP file with Foxglove's schemas: log time = time of
/// recording, publish time = utime of the message. Reads the log twice, first for its channels;
/// memory does not depend on its length. Fails when the log cannot be read, when nothing of it has
/// a counterpart, and, naming the file, when it cannot be written. When `stop` is requested, it
/// fails with kMcapStopped, and there is no file.
Result<McapExport> WriteMcap(LogReader& reader, const McapExportOptions& options,
                             const std::filesystem::path& out, const StopSignal* stop = nullptr);
inline constexpr const char* kMcapStopped = "stopped before the end; no file was written";

/// Whether a log has no frame, surface, free space or objects of ours, but images of other robots'
/// programs: such a log is written as a sequence, see map_to_mcap.h.
Result<bool> HasForeignFramesOnly(const LogReader& reader, const AdapterOptions& adapter,
                                  const StopSignal* stop = nullptr);

}  // namespace vismap
