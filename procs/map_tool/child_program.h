#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "runtime/stop_signal.h"

namespace vismap {

/// Runs vismap-NAME, which stands beside this program, to its end. What it writes to stderr is
/// seen; what it writes to stdout is not. When the stop is requested, it gets SIGTERM. Fails when
/// it cannot be started, was stopped, or ends with another exit code than 0, with its name and what
/// happened.
Result<void> RunSibling(const std::string& name, const std::vector<std::string>& arguments,
                        const StopSignal& stop);

}  // namespace vismap
