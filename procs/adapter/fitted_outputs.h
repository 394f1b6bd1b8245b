#pragma once

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "adapter/output_report.h"
#include "base/raw_bytes.h"
#include "config/process_options.h"
#include "freespace/occupancy_map.h"
#include "meshing/mesh.h"
#include "objects/objects.h"
#include "runtime/lcm_url.h"

namespace vismap {

/// The largest message that the readers of a bus get [bytes]. LCM's udpm sends all fragments of a
/// message at once: readers lose it when it is larger than their receive buffer. It may take half
/// of the one that the URL names, since images arrive meanwhile, and at most 8 MB, since LCM holds
/// 16 MB of messages that are not complete.
size_t LargestOutput(const LcmUrl& url);

/// Makes the messages of other programs from the map, on the channels that the options name. What
/// would be larger than the bus takes gets a coarser spacing, and the report says so.
class FittedOutputs {
 public:
  /// Sends a message; returns false when that fails.
  using Send = std::function<bool(const std::string& channel, std::span<const uint8_t> bytes)>;

  /// `most_bytes`: of a message. `report` must outlive it. No further message is made once
  /// `stopped` returns true, so that the process ends soon.
  FittedOutputs(
      const AdapterOptions& options, size_t most_bytes, OutputReport* report, Send send,
      std::function<bool()> stopped = [] { return false; });

  /// The times are those of the newest frame in the surface and in the list of objects [us].
  void PublishSurface(const Mesh& mesh, int64_t utime, std::span<const ObjectSummary> objects,
                      int64_t objects_utime);
  void PublishSpace(const OccupancyMap& space, int64_t utime);

 private:
  template <typename Make>
  void Publish(const std::string& channel, double wanted, const char* key, const Make& make);
  template <typename Message>
  void SendNow(const std::string& channel, Message message);
  void TellSpacing(const std::string& channel, double wanted, double spacing, const char* key);
  std::span<const ObjectSummary> Bounded(std::span<const ObjectSummary> objects);

  AdapterOptions options_;
  std::string root_;  // frame that the map is in
  size_t most_bytes_;
  OutputReport* report_;
  Send send_;
  std::function<bool()> stopped_;
  std::map<std::string, double> spacings_;  // of each channel [m]
  std::set<std::string> boxes_in_director_;
};

}  // namespace vismap
