#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "geometry/frame.h"

namespace vismap {

/// Notices when two processes publish frames of one camera id at the same time. Of their frames
/// with equal utimes, only one would be mapped.
class CameraSources {
 public:
  /// A source that was silent for so long no longer counts [s].
  static constexpr double kSilence = 5;

  /// Adds a frame that `source` has published as its message number `seq` and that was received at
  /// time `now` [s]. Returns a sentence for STATUS when another process publishes frames of this
  /// camera, too. It may have the same name: then the numbers go back again and again.
  std::optional<std::string> Add(CameraId camera, const std::string& source, int64_t seq,
                                 double now);

 private:
  static constexpr size_t kMaxSources = 256;
  struct Source {
    double last_heard = 0;  // [s]
    int64_t seq = -1;
    int steps_back = 0;  // of seq; one restart is one step
  };
  std::map<CameraId, std::map<std::string, Source>> heard_;
  size_t size_ = 0;
};

/// Whether `finding` is a sentence of CameraSources about frames of this source.
bool IsAboutSharedCamera(const std::string& finding, const std::string& source);

}  // namespace vismap
