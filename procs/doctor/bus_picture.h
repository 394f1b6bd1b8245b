#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>
#include <vismap/process_status_t.hpp>

namespace vismap {

/// What was observed of one process.
struct ProcessPicture {
  process_status_t first, last;  ///< its first STATUS (since its last start) and its latest one
  double last_heard = 0;         ///< time of the latest STATUS [s]
  double clock_difference = 0;   ///< its clock minus the clock of this computer [s]
  int restarts = 0;              ///< observed restarts
  /// "computer, pid N" of the processes that use this name at the same time.
  std::set<std::string> places;
};

/// What was observed of one channel.
struct ChannelPicture {
  int64_t messages = 0, bytes = 0;
  int64_t gaps = 0;     ///< missing sequence numbers, over all sources
  int64_t foreign = 0;  ///< messages of a wrong type, of another version of the type, or too large
  double last = 0;      ///< time of the latest message [s]
  std::map<std::string, int64_t> last_seq;  ///< latest sequence number of each source
};

/// Summary of all messages that were received on a bus. Decodes only the heads of messages, except
/// for STATUS.
class BusPicture {
 public:
  /// Adds a received message. `now` is the time of a monotonic clock [s], `utime` that of the wall
  /// clock [us].
  void AddMessage(const std::string& channel, std::span<const uint8_t> data, double now,
                  int64_t utime);

  /// All processes, by the name of their instance. When several have one name, all but one have
  /// their place added: "map-server (computer, pid N)", so that none hides another.
  const std::map<std::string, ProcessPicture>& processes() const { return processes_; }
  const std::map<std::string, ChannelPicture>& channels() const { return channels_; }
  /// Number of messages of one channel.
  int64_t messages(const std::string& channel) const;
  /// Whether an instance of this program was observed that is not stopping.
  bool Has(const std::string& process) const;

 private:
  void AddStatus(std::span<const uint8_t> data, double now, int64_t utime);
  ProcessPicture* PictureOf(const process_status_t& status);

  std::map<std::string, ProcessPicture> processes_;
  std::map<std::string, ChannelPicture> channels_;
};

/// Value of a counter in a STATUS; 0 when there is no counter with this name.
int64_t CounterOf(const process_status_t& status, const std::string& name);

}  // namespace vismap
