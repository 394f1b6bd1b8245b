#pragma once

#include <string>
#include <vector>

#include "doctor/bus_picture.h"
#include "runtime/self_check.h"

namespace vismap {

/// A problem, and what to do about it.
struct Finding {
  std::string what;  ///< one sentence that describes the problem
  std::string todo;  ///< a command or a hint; "" = `what` has it already
};

/// How the bus was observed.
struct Listening {
  std::vector<CheckResult> checks;  ///< of the connection
  double seconds = 0;               ///< duration of the observation [s]
  double now = 0;                   ///< its end, on the monotonic clock of BusPicture [s]
  std::string lcm_url;              ///< URL of the bus
};

/// Finds all problems in an observation, causes before their consequences. Empty = the bus is
/// healthy.
std::vector<Finding> Diagnose(const Listening& listening, const BusPicture& picture);

}  // namespace vismap
