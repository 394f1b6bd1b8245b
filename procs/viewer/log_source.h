#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/result.h"
#include "config/config.h"
#include "logs/recording.h"
#include "sequence_mapper/sequence_input.h"
#include "viewer/log_evidence.h"
#include "viewer/log_recording.h"

namespace vismap {

/// Maps a log, or another recorded sequence, in a thread of its own, as vismap-offline-mapper does,
/// and records what the map becomes.
class LogSource {
 public:
  /// Opens the log and its detections: see OpenRecording and OpenSequenceDetector. Fails when it
  /// has no usable frame, and says which channels it has.
  static Result<std::unique_ptr<LogSource>> Open(const std::string& path,
                                                 const VismapConfig& config);
  /// Ends the mapping.
  ~LogSource();

  void Start();
  const LogRecording& recording() const { return *recorded_; }
  /// Frames that are kept to show objects in.
  const LogFrames& frames() const { return frames_; }
  /// The map after so many frames: from the copy before it, by mapping those between. Fails when
  /// the log has not so many, and when `stop` was set. For one other thread, once the log is
  /// mapped.
  Result<std::shared_ptr<const LoadedMap>> MapAfter(int64_t frames,
                                                    const std::atomic<bool>* stop) const;
  const std::string& name() const { return name_; }

 private:
  LogSource(const VismapConfig& config, Recording log, SequenceDetector detector,
            std::unique_ptr<LogRecording> recorded);
  MapMetadata NewMetadata() const;
  void Map();
  void MapAll();

  VismapConfig config_;
  Recording log_;
  SequenceDetector detector_;
  std::unique_ptr<LogRecording> recorded_;
  LogFrames frames_;
  std::string name_;
  RecordingState state_;
  std::vector<size_t> read_after_;  // frames of the log that were read when the map had 1, 2, ...
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace vismap
