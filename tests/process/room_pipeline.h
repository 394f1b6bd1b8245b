#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <vismap/map_reply_t.hpp>

#include "process/process_harness.h"

namespace vismap {

/// A small built-in room, and all processes that map it in lockstep. What they are started with can
/// be changed before Start; any of them may be killed and started again.
class RoomPipeline {
 public:
  static constexpr int kFrames = 16;
  static constexpr char kRoom[] = "synthetic:room?frames=16&width=160";

  explicit RoomPipeline(ProcessBus* processes) : RoomPipeline(processes, processes) {}
  /// Map server and exporter on another bus than the rest.
  RoomPipeline(ProcessBus* processes, ProcessBus* map_processes)
      : processes_(processes), map_processes_(map_processes) {}

  std::vector<std::string> server_arguments{"--threads", "2"};
  std::vector<std::string> exporter_arguments;
  std::vector<std::string> detector_arguments{"--dataset", kRoom};
  std::vector<std::string> segmenter_arguments;
  std::string detections = "required";  ///< of the segmenter; with "none" there is no detector
  double resend = 0.5;                  ///< of the replay [s]

  /// Starts all; counts the frames that the server says it integrated.
  void Start();
  void StartServer();
  void StartSegmenter();
  void StartDetector();
  void StartExporter();
  /// Waits until so many frames are integrated; false when it takes too long.
  bool WaitForFrames(int count);
  /// Waits for the replay to end well.
  void WaitForEnd();

  int integrated() const { return integrated_; }
  std::unique_ptr<ChildProcess> server, segmenter, detector, exporter, replay;

 private:
  ProcessBus* processes_;
  ProcessBus* map_processes_;
  int integrated_ = 0;
};

/// Kills a process as a crash does and waits until it is gone.
void Crash(ChildProcess* process);

/// The answer to a request, which is asked again until somebody answers.
map_reply_t Ask(ProcessBus* processes, const std::string& verb, const std::string& argument = "");

/// "hash", "occupancy_digest" and other figures of the server's map.
std::string ServerStatistic(ProcessBus* processes, const std::string& name);

/// Waits until the exporter has the server's revision; expects the same occupancy then.
void ExpectExporterIsLevel(ProcessBus* processes);

/// The map hash that the offline mapper gets from a sequence; `more` = further arguments.
std::string OfflineRoomHash(const std::string& threads = "2",
                            const std::string& dataset = RoomPipeline::kRoom,
                            const std::vector<std::string>& more = {});

}  // namespace vismap
