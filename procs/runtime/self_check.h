#pragma once

#include <string>
#include <vector>

#include "runtime/lcm_url.h"

namespace vismap {

/// One thing that a bus needs of this computer.
struct CheckResult {
  std::string what;  ///< for example "multicast route"
  bool ok = false;
  std::string found;  ///< when not ok, ends with the one command that mends it
};

/// What can be known without joining: for tcpq whether a hub answers within `timeout` [s], for udpm
/// the multicast route and the receive buffer.
std::vector<CheckResult> CheckBus(const LcmUrl& url, double timeout);

/// Says in the log what of that is wrong for a bus without a hub; a hub is waited for instead.
void WarnAboutBus(const LcmUrl& url);

/// "vismap-hub --listen A.B.C.D:PORT" of a tcpq URL.
std::string HubCommand(const LcmUrl& url);

}  // namespace vismap
