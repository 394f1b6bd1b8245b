#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "adapter/robot_bus.h"
#include "config/process_options.h"
#include "objects/objects.h"
#include "runtime/bus.h"
#include "runtime/catch_up.h"
#include "runtime/pacer.h"
#include "runtime/status.h"
#include "wire/map_follower.h"
#include "wire/mesh_follower.h"

namespace vismap {

/// Follows the map and publishes it on the robot's bus in the messages of other programs, on the
/// channels that the options name, when it has changed and at most once a period.
class MapOutputs {
 public:
  /// Subscribes to what the outputs need. `bus`, `status` and `robot` must outlive it.
  MapOutputs(const AdapterOptions& options, Bus* bus, Status* status, RobotBus* robot);

 private:
  bool WantsSurface() const;
  Result<void> OnMesh(const mesh_delta_t& message);
  Result<void> OnSpace(const map_delta_t& message);
  void OnTimer();
  void PublishSurface();
  void PublishSpace();
  template <typename Message>
  void Send(const std::string& channel, Message message);

  AdapterOptions options_;
  std::string root_;  // frame that the map is in
  Bus* bus_;
  Status* status_;
  RobotBus* robot_;
  MeshFollower mesh_;
  MapFollower space_;
  std::vector<ObjectSummary> objects_;
  int64_t objects_utime_ = 0;
  bool objects_changed_ = false;
  CatchUp mesh_catch_up_, space_catch_up_;
  FollowerPosition surface_published_, space_published_;
  Pacer surface_pacer_, space_pacer_;
  std::set<std::string> boxes_in_director_;
};

}  // namespace vismap
