#pragma once

#include <memory>
#include <string>
#include <vector>

#include "adapter/output_report.h"
#include "adapter/robot_bus.h"
#include "foreign/camera_joiners.h"
#include "foreign/presets.h"
#include "runtime/bus.h"
#include "runtime/pacer.h"
#include "runtime/status.h"

namespace vismap {

/// Reads images and poses of other programs from the robot's bus, and publishes them as RGBD_FRAME
/// with a STATUS that says what is dropped and what to do.
class Adapter {
 public:
  /// For options with their preset. `bus`, `status`, `robot` and `outputs` must outlive it. The
  /// STATUS has what `outputs` tells; nullptr = none. Fails as CameraJoiners::Create does.
  static Result<std::unique_ptr<Adapter>> Create(const AdapterOptions& options, Bus* bus,
                                                 Status* status, RobotBus* robot,
                                                 OutputReport* outputs);

  /// Handles what arrives until stop is requested.
  void Run();

 private:
  Adapter(const AdapterOptions& options, Bus* bus, Status* status, RobotBus* robot,
          OutputReport* outputs)
      : cameras_(CamerasOf(options)),
        bus_(bus),
        status_(status),
        robot_(robot),
        outputs_(outputs) {}
  int64_t Now() const;
  void FollowWallClock();
  void Publish(const AdapterCameraOptions& camera, ForeignFrame&& frame);
  void UpdateStatus();
  void TellLosses();
  std::vector<std::string> SilentChannels() const;

  std::vector<AdapterCameraOptions> cameras_;
  Bus* bus_;
  Status* status_;
  RobotBus* robot_;
  OutputReport* outputs_;
  std::unique_ptr<CameraJoiners> joiners_;
  int64_t start_wall_ = 0;
  double start_ = 0;
  int64_t wall_offset_ = 0;  // by how much the wall clock was set since [us]
  struct Losses {
    int64_t before = 0;
    double last = -1e9;  // MonotonicSeconds
  };
  Losses dropped_, ignored_;
};

}  // namespace vismap
