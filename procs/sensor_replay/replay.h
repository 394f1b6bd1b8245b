#pragma once

#include <string>
#include <vector>

#include "config/process_options.h"
#include "datasets/dataset.h"
#include "runtime/main.h"

namespace vismap {

/// When a replay starts and ends. These options exist on the command line only.
struct ReplayBounds {
  std::vector<std::string> wait_for;  ///< programs that must be ready before the first frame
  bool loop = false;                  ///< start again at the end; utimes keep increasing
};

/// Publishes the frames of `dataset` as RGBD_FRAME. In lockstep it succeeds only when all frames
/// were committed.
Outcome Replay(const Dataset& dataset, const SensorReplayOptions& options,
               const ReplayBounds& bounds, ProcessContext& context);

}  // namespace vismap
