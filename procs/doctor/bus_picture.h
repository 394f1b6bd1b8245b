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
  /// Set for a channel that is none of ours by its prefix, but carries messages of our type.
  std::string type_of_ours = {}, other_prefix = {};
};

/// What was observed of the frames of one camera.
struct CameraPicture {
  int64_t newest_frame = -1;   ///< utime of the last RGBD_FRAME [us]; -1 = none
  int64_t newest_commit = -1;  ///< utime of the last MAP_COMMIT [us]; -1 = none
  double first_lag = 0;        ///< of the map behind the camera when both were known first [s]
  /// Since when the map has been more than kToldLag behind [s]; -1 = it is not.
  double behind_since = -1;
  static constexpr double kToldLag = 2;  // [s]
  /// By how much the map is behind the camera [s]; 0 when that is not known.
  double Lag() const;
};

/// Summary of all messages that were received on a bus. Decodes only the heads of messages, except
/// for STATUS. Of programs with another prefix, only hubs and bridges count.
class BusPicture {
 public:
  /// `channel_prefix` stands before the names of our channels on the bus.
  explicit BusPicture(const std::string& channel_prefix = "") : channel_prefix_(channel_prefix) {}

  /// Adds a received message. `now` is the time of a monotonic clock [s], `utime` that of the wall
  /// clock [us].
  void AddMessage(const std::string& on_bus, std::span<const uint8_t> data, double now,
                  int64_t utime);

  /// All processes, by the name of their instance. When several have one name, all but one have
  /// their place added: "map-server (computer, pid N)", so that none hides another.
  const std::map<std::string, ProcessPicture>& processes() const { return processes_; }
  /// By the names on the bus, with their prefixes.
  const std::map<std::string, ChannelPicture>& channels() const { return channels_; }
  const std::string& channel_prefix() const { return channel_prefix_; }
  const std::map<int32_t, CameraPicture>& cameras() const { return cameras_; }
  /// Number of messages of one of our channels, by its name without prefix.
  int64_t messages(const std::string& channel) const;
  /// Whether an instance of this program was observed that is not stopping.
  bool Has(const std::string& process) const;

 private:
  void AddStranger(const std::string& on_bus, std::span<const uint8_t> data, double now,
                   int64_t utime);
  void AddFrame(const std::string& channel, std::span<const uint8_t> data, double now);
  void AddStatus(std::span<const uint8_t> data, double now, int64_t utime, bool other_prefix);
  ProcessPicture* PictureOf(const process_status_t& status);

  std::string channel_prefix_;
  std::map<std::string, ProcessPicture> processes_;
  std::map<std::string, ChannelPicture> channels_;
  std::map<int32_t, CameraPicture> cameras_;  // by id
};

/// Value of a counter in a STATUS; 0 when there is no counter with this name.
int64_t CounterOf(const process_status_t& status, const std::string& name);

}  // namespace vismap
