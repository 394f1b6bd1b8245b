#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <vismap/map_reply_t.hpp>

#include "process/process_harness.h"

namespace vismap {

/// All processes that map a small built-in room in lockstep. Their arguments can be changed before
/// Start; each process may be killed and started again.
class RoomPipeline {
 public:
  static constexpr int kFrames = 16;
  static constexpr char kRoom[] = "synthetic:room?frames=16&width=160";

  explicit RoomPipeline(ProcessBus* processes) : RoomPipeline(processes, processes) {}
  /// Map server and exporter on another bus than the rest.
  RoomPipeline(ProcessBus* processes, ProcessBus* map_processes)
      : processes_(processes), map_processes_(map_processes) {}

  std::string dataset = kRoom;  ///< of the replay; the detector sees kRoom
  std::vector<std::string> server_arguments{"--threads", "2"};
  std::vector<std::string> exporter_arguments;
  std::vector<std::string> detector_arguments{"--dataset", kRoom};
  std::vector<std::string> segmenter_arguments;
  std::string detections =
      "required";       ///< --detections of the segmenter; "none" = no detector is started
  double resend = 0.5;  ///< --resend-s of the replay [s]

  /// Starts all processes and counts the integrated frames.
  void Start();
  void StartServer();
  void StartSegmenter();
  void StartDetector();
  void StartExporter();
  /// Waits until this number of frames is integrated; returns false when it takes too long.
  bool WaitForFrames(int count);
  /// Waits until the replay has ended successfully.
  void WaitForEnd();

  int integrated() const { return integrated_; }
  std::unique_ptr<ChildProcess> server, segmenter, detector, exporter, replay;

 private:
  ProcessBus* processes_;
  ProcessBus* map_processes_;
  int integrated_ = 0;
};

/// Kills a process, as in a crash, and waits until it has ended.
void Crash(ChildProcess* process);

/// Sends a request, repeatedly, until it is answered; returns the answer.
map_reply_t Ask(ProcessBus* processes, const std::string& verb, const std::string& argument = "");

/// A value of the statistics of the live map, for example "hash" or "occupancy_digest".
std::string ServerStatistic(ProcessBus* processes, const std::string& name);

/// Waits until the exporter has the revision of the server; expects equal occupancy then.
void ExpectExporterIsLevel(ProcessBus* processes);

/// The map hash of the offline mapper for a sequence; `more` = further arguments.
std::string OfflineRoomHash(const std::string& threads = "2",
                            const std::string& dataset = RoomPipeline::kRoom,
                            const std::vector<std::string>& more = {});

}  // namespace vismap
