#pragma once

#include <string>
#include <vector>

#include "doctor/bus_picture.h"
#include "runtime/self_check.h"

namespace vismap {

/// Something that is wrong, and what to do about it.
struct Finding {
  std::string what;  ///< one sentence
  std::string todo;
};

/// How the bus was listened to.
struct Listening {
  std::vector<CheckResult> checks;
  double seconds = 0;
  double now = 0;       ///< end of it, by the clock of the picture [s]
  std::string lcm_url;  ///< what processes have to be given to join
};

/// Everything that is wrong with what was seen and heard, the cause before its consequences. Empty
/// = the bus is healthy.
std::vector<Finding> Diagnose(const Listening& listening, const BusPicture& picture);

}  // namespace vismap
