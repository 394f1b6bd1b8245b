#pragma once

#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "runtime/main.h"

namespace vismap {

/// How a sequence is played.
struct ReplayOptions {
  bool lockstep = false;  ///< false: in real time, whether anybody listens or not
  double speed = 1;       ///< of real time; 0 = as fast as frames can be read
  int window = 4;         ///< lockstep: frames sent ahead of the oldest that is not committed
  double resend_after =
      5;  ///< lockstep: silence of the map server after which open frames are sent again [s]
  bool loop = false;                  ///< begin again at the end; utimes go on increasing
  std::vector<std::string> wait_for;  ///< programs that must be ready before the first frame
};

/// Publishes the frames of `dataset` as RGBD_FRAME. In lockstep it succeeds only when every frame
/// was committed.
Outcome Replay(const Dataset& dataset, const ReplayOptions& options, ProcessContext& context);

}  // namespace vismap
