#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>

#include "wire/frame_key.h"

namespace vismap {

/// How the newest map of a recorded run was made, by the MAP_COMMITs of its server.
struct MapHistory {
  std::string map_id;                       ///< empty = no frame was integrated
  std::vector<frame_commit_t> integrated;   ///< by revision: the order in which the map was made
  std::map<FrameKey, std::string> skipped;  ///< frames that were left out, and why
  std::vector<std::string> remarks;         ///< why the frames may not make the recorded map again
};

/// Follows the newest map back to its first frame, also over restarts of its server that went on
/// from a saved map. `commits` = all of the run, as recorded.
MapHistory HistoryOfNewestMap(const std::vector<frame_commit_t>& commits);

}  // namespace vismap
