#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/result.h"
#include "mapfile/map_file.h"
#include "viewer/log_recording.h"

namespace vismap {

/// The whole map at any moment of a log that is mapped: from the copy before it, by mapping the
/// frames between in a thread of its own.
class MomentMaps {
 public:
  static constexpr size_t kMostKept = 3;

  using MapPtr = std::shared_ptr<const LoadedMap>;
  /// Makes the map after so many frames; may end early when `stop` is set. See LogSource::MapAfter.
  using MakeMap = std::function<Result<MapPtr>(int64_t frames, const std::atomic<bool>* stop)>;

  /// `recording` must outlive it. Of the maps that it makes, it keeps the last ones that take at
  /// most `max_bytes` together, and the last one in any case.
  MomentMaps(const LogRecording* recording, MakeMap make, size_t max_bytes);
  /// Ends what is being computed.
  ~MomentMaps();

  /// The map after so many frames, which must be those of a moment. While the log is still being
  /// mapped, that of the copy before it. nullptr = it is being computed, ask again. An Error says
  /// why it cannot be computed.
  Result<MapPtr> Get(int64_t frames);

 private:
  void Run();
  Result<MapPtr> Make(int64_t frames) const;
  MapPtr Find(int64_t frames) const;
  void Keep(MapPtr map);

  const LogRecording* recording_;
  MakeMap make_;
  size_t max_bytes_;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<int64_t> wanted_;          // frames
  std::list<MapPtr> kept_;                 // newest first
  std::map<int64_t, std::string> failed_;  // sentences by frames
  std::thread thread_;
};

}  // namespace vismap
