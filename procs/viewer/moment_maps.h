#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "mapfile/map_file.h"
#include "viewer/log_source.h"

namespace vismap {

/// The whole map at any moment of a log that is mapped: from the copy before it, by mapping the
/// frames between in a thread of its own.
class MomentMaps {
 public:
  static constexpr size_t kMostKept = 3;

  /// `source` must outlive it.
  explicit MomentMaps(const LogSource* source);
  /// Ends what is being computed.
  ~MomentMaps();

  /// The map after so many frames, which must be those of a moment. While the log is still being
  /// mapped, that of the copy before it. nullptr = it is being computed, ask again.
  std::shared_ptr<const LoadedMap> Get(int64_t frames);

 private:
  void Run();
  std::shared_ptr<const LoadedMap> Find(int64_t frames) const;

  const LogSource* source_;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<int64_t> wanted_;                     // frames
  std::list<std::shared_ptr<const LoadedMap>> kept_;  // newest first
  std::thread thread_;
};

}  // namespace vismap
