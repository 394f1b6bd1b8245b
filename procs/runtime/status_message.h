#pragma once

#include <cstdint>
#include <string>
#include <vismap/process_status_t.hpp>

namespace vismap {

/// A status of this process with all that does not change filled in: time, host, pid, version,
/// types. `process` = which program; `start_utime` = when it was started [us].
process_status_t MakeStatus(const std::string& process, int64_t start_utime);

/// Name of this computer.
std::string HostName();

void AddCounter(process_status_t* message, const std::string& name, int64_t value);

}  // namespace vismap
