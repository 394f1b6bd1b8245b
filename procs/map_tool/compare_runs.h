#pragma once

#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>

#include "logs/arrivals.h"
#include "logs/map_history.h"

namespace vismap {

/// The parts of a log that describe a run.
struct RunRecord {
  std::string name;  ///< path of the log, for messages
  MapHistory history;
  std::vector<Arrival> arrivals;
};

/// Reads a log. Fails when it cannot be read or holds no MAP_COMMIT of an integrated frame.
Result<RunRecord> ReadRunRecord(const std::string& path, const std::string& channel_prefix = "");

/// A sentence on the first frame at which two runs differ, in the order of integration; "" = they
/// built the same map from the same input.
std::string FirstDifference(const RunRecord& a, const RunRecord& b);

/// Sentences on the length of the runs, and on whether the messages arrived in different orders, on
/// which the map must not depend.
std::vector<std::string> CompareFacts(const RunRecord& a, const RunRecord& b);

}  // namespace vismap
