#pragma once

#include <string>

#include "config/config.h"
#include "map_server/frame_mapper.h"
#include "map_server/live_map.h"
#include "map_server/map_requests.h"
#include "map_server/pose_corrections.h"
#include "runtime/bus.h"
#include "runtime/status.h"

namespace vismap {

/// Owns the map: integrates frames (FrameMapper), publishes what changed (MapPublisher), saves and
/// loads (MapStore), carries out requests (MapRequests), and corrects poses (PoseCorrections).
class MapServer {
 public:
  /// Subscribes to its inputs. `bus` and `status` must outlive it.
  MapServer(const VismapConfig& config, Bus* bus, Status* status);

  LiveMap& map() { return map_; }
  /// Serves until stop is requested.
  void Run();
  /// Waits for the request that has begun, and answers it; gives up a correction of poses.
  void Finish() {
    requests_.Finish();
    corrections_.Stop();
  }
  /// What became of the frames, see FrameMapper.
  std::string Summary() const { return frames_.Summary(); }

 private:
  Bus& bus_;
  LiveMap map_;
  FrameMapper frames_;
  MapRequests requests_;
  PoseCorrections corrections_;
};

}  // namespace vismap
