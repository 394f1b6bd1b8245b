#pragma once

#include <cstdint>
#include <string>
#include <vismap/process_status_t.hpp>

namespace vismap {

/// A STATUS message of this process with time, host, pid, version, types_fingerprint and the
/// counter memory_bytes filled in. `process` is the name of the program, `start_utime` the time of
/// its start [us].
process_status_t MakeStatus(const std::string& process, int64_t start_utime);

/// Memory that this process has at present [bytes].
int64_t ResidentBytes();

/// The host name of this computer.
std::string HostName();

void AddCounter(process_status_t* message, const std::string& name, int64_t value);

}  // namespace vismap
