#pragma once

#include <cstdint>
#include <string>
#include <vismap/process_status_t.hpp>

namespace vismap {

/// A STATUS message of this process with time, host, pid, version and types_fingerprint filled in.
/// `process` is the name of the program, `start_utime` the time of its start [us].
process_status_t MakeStatus(const std::string& process, int64_t start_utime);

/// The host name of this computer.
std::string HostName();

void AddCounter(process_status_t* message, const std::string& name, int64_t value);

}  // namespace vismap
