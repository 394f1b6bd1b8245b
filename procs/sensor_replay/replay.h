#pragma once

#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "runtime/main.h"

namespace vismap {

/// How a sequence is replayed.
struct ReplayOptions {
  bool lockstep = false;  ///< wait for the commits of the map server; false = real time
  double speed = 1;       ///< relative to real time; 0 = as fast as frames can be read
  int window = 4;         ///< lockstep: largest number of sent frames that are not committed yet
  double resend_after =
      5;              ///< lockstep: time without a commit after which frames are sent again [s]
  bool loop = false;  ///< start again at the end; utimes keep increasing
  std::vector<std::string> wait_for;  ///< programs that must be ready before the first frame
};

/// Publishes the frames of `dataset` as RGBD_FRAME. In lockstep it succeeds only when all frames
/// were committed.
Outcome Replay(const Dataset& dataset, const ReplayOptions& options, ProcessContext& context);

}  // namespace vismap
