#pragma once

#include <string>
#include <vector>

#include "runtime/lcm_url.h"

namespace vismap {

/// The result of checking one thing that the bus needs on this computer.
struct CheckResult {
  std::string what;  ///< what was checked, for example "multicast route"
  bool ok = false;
  /// What was found; when not ok, it ends with the command that solves the problem.
  std::string found;
};

/// Checks what can be checked without connecting: for tcpq whether a hub answers within `timeout`
/// [s], for udpm the multicast route and the receive buffer.
std::vector<CheckResult> CheckBus(const LcmUrl& url, double timeout);

/// What such a check found wrong, in sentences that end with the command that solves the problem.
/// None for tcpq, because those who connect wait for the hub.
std::vector<std::string> BusProblems(const LcmUrl& url);

/// Logs a warning for each of them.
void WarnAboutBus(const LcmUrl& url);

/// The command that starts the hub of a tcpq URL: "vismap-hub --listen A.B.C.D:PORT".
std::string HubCommand(const LcmUrl& url);

}  // namespace vismap
