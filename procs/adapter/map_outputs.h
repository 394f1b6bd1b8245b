#pragma once

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "adapter/fitted_outputs.h"
#include "adapter/output_report.h"
#include "adapter/robot_bus.h"
#include "config/process_options.h"
#include "objects/objects.h"
#include "runtime/bus.h"
#include "runtime/catch_up.h"
#include "runtime/pacer.h"
#include "wire/map_follower.h"
#include "wire/mesh_follower.h"

namespace vismap {

/// Follows the map and makes messages of other programs from it, when it has changed and at most
/// once a period.
class MapOutputs {
 public:
  /// Subscribes to what the outputs need. `bus` and `report` must outlive it.
  MapOutputs(const AdapterOptions& options, size_t most_bytes, Bus* bus, OutputReport* report,
             FittedOutputs::Send send);

  /// Whether the options name a channel for the map.
  static bool Wanted(const AdapterOptions& options);

 private:
  Result<void> OnMesh(const mesh_delta_t& message);
  Result<void> OnSpace(const map_delta_t& message);
  void OnTimer();
  void PublishSurface();
  void PublishSpace();

  AdapterOptions options_;
  Bus* bus_;
  OutputReport* report_;
  FittedOutputs outputs_;
  MeshFollower mesh_;
  MapFollower space_;
  std::vector<ObjectSummary> objects_;
  int64_t objects_utime_ = 0;
  bool objects_changed_ = false;
  CatchUp mesh_catch_up_, space_catch_up_;
  FollowerPosition surface_published_, space_published_;
  Pacer surface_pacer_, space_pacer_;
};

/// MapOutputs in a thread of its own, with its own connections to both buses, so that a large map
/// does not delay images.
class OutputThread {
 public:
  /// Starts it with connections that are open. `stop` ends them, and must outlive it.
  OutputThread(const AdapterOptions& options, std::unique_ptr<Bus> bus,
               std::unique_ptr<RobotBus> robot, StopSignal* stop);
  /// Requests `stop` and waits for the end of the output that is being made.
  ~OutputThread();
  OutputThread(const OutputThread&) = delete;
  OutputThread& operator=(const OutputThread&) = delete;

  OutputReport& report() { return report_; }

 private:
  void Run();
  void ReportBus();

  AdapterOptions options_;
  std::unique_ptr<Bus> bus_;
  std::unique_ptr<RobotBus> robot_;
  StopSignal* stop_;
  OutputReport report_;
  std::thread thread_;
};

}  // namespace vismap
