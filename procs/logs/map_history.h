#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>

#include "wire/frame_key.h"

namespace vismap {

/// How the newest map of a recorded run was built, according to the MAP_COMMITs of its server.
struct MapHistory {
  std::string map_id;  ///< empty = no frame was integrated
  /// By ascending revision, the order in which the map was built.
  std::vector<frame_commit_t> integrated;
  std::map<FrameKey, std::string> skipped;  ///< frames that were not integrated, and the reason
  std::vector<std::string> remarks;         ///< why these frames may not reproduce the recorded map
};

/// Traces the newest map back to its first frame, also across restarts of the server that continued
/// a saved map. `commits` are all commits of the run, in recorded order.
MapHistory HistoryOfNewestMap(const std::vector<frame_commit_t>& commits);

}  // namespace vismap
