#pragma once

#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>

#include "logs/arrivals.h"
#include "logs/map_history.h"

namespace vismap {

/// What a log says of how a run went.
struct RunRecord {
  std::string name;  ///< of the log, for sentences
  MapHistory history;
  std::vector<Arrival> arrivals;
};

/// Reads a log. Fails when it cannot be read or holds no MAP_COMMIT of an integrated frame.
Result<RunRecord> ReadRunRecord(const std::string& path);

/// The first frame at which two runs part, and how; empty = they made the same map of the same
/// inputs. Frames are taken in the order in which they were integrated.
std::string FirstDifference(const RunRecord& a, const RunRecord& b);

/// Sentences: length of the runs, and whether messages arrived in other orders, which the map must
/// not depend on.
std::vector<std::string> CompareFacts(const RunRecord& a, const RunRecord& b);

}  // namespace vismap
