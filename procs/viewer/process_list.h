#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vismap/process_status_t.hpp>

namespace vismap {

/// The memory of the map by layer, from the counters memory.LAYER_bytes of the map server.
std::map<std::string, int64_t> MemoryLayers(const process_status_t& status);

/// What the STATUS messages say of the processes on the bus, for the page.
class ProcessList {
 public:
  static constexpr size_t kMost = 128;         ///< processes; further ones are left out
  static constexpr double kForgetAfter = 600;  ///< a process that was not heard for so long [s]

  /// Adds a STATUS that was received at time `now` [s] of a monotonic clock.
  void Add(const process_status_t& status, double now);
  /// The text of the kind `processes`: for each process its newest STATUS, its age, and by how much
  /// its counters grew per second between its two newest ones. Percentiles stand with the timings.
  std::string Text(double now, int64_t now_utime);
  size_t size() const { return heard_.size(); }
  /// Whether a program of this name, such as "octomap-exporter", was heard in the last 3 s.
  bool IsAlive(const std::string& process, double now) const;

 private:
  struct Heard {
    process_status_t status;
    double at = 0;                        // [s]
    std::map<std::string, double> rates;  // of counters that grew, per second
  };
  std::map<std::string, Heard> heard_;  // by source
};

}  // namespace vismap
