#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>
#include <vismap/process_status_t.hpp>

namespace vismap {

/// What was seen of one process.
struct ProcessPicture {
  process_status_t first, last;  ///< of its STATUS
  double last_heard = 0;         ///< [s]
  double clock_difference = 0;   ///< of its clock to ours [s]
  int restarts = 0;              ///< seen
  std::set<std::string> places;  ///< "computer, pid" of all who spoke under this name at once
};

/// What was seen of one channel.
struct ChannelPicture {
  int64_t messages = 0, bytes = 0;
  int64_t gaps = 0;     ///< numbers missing in the sequences of its sources
  int64_t foreign = 0;  ///< messages of another type, or another version of it, or too large
  double last = 0;      ///< when the last one came [s]
  std::map<std::string, int64_t> last_seq;  ///< per source
};

/// Everything that was heard on a bus for a while. Looks at the heads of messages only, but for
/// STATUS.
class BusPicture {
 public:
  /// `now` [s] of a clock that only goes forward, `utime` of the wall clock [us].
  void AddMessage(const std::string& channel, std::span<const uint8_t> data, double now,
                  int64_t utime);

  /// By name of the instance.
  const std::map<std::string, ProcessPicture>& processes() const { return processes_; }
  const std::map<std::string, ChannelPicture>& channels() const { return channels_; }
  int64_t messages(const std::string& channel) const;
  /// Some instance of this program was heard.
  bool Has(const std::string& process) const;

 private:
  void AddStatus(std::span<const uint8_t> data, double now, int64_t utime);

  std::map<std::string, ProcessPicture> processes_;
  std::map<std::string, ChannelPicture> channels_;
};

/// Value of a counter of a status; 0 when it has none of that name.
int64_t CounterOf(const process_status_t& status, const std::string& name);

}  // namespace vismap
