#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
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
  /// The numbers of two processes with one name must alternate several times in so long [s].
  static constexpr double kMemoryOfReturns = 15;
  /// So many sources are known at a time; further ones are not watched.
  static constexpr size_t kMaxSources = 256;

  /// Adds a frame that `source` has published as its message number `seq` and that was received at
  /// time `now` [s]. Returns a sentence for STATUS when another process publishes frames of this
  /// camera, too. It may have the same name: then the numbers of the two alternate. A process that
  /// was restarted, even many times, is no other process.
  std::optional<std::string> Add(CameraId camera, const std::string& source, int64_t seq,
                                 double now);
  size_t cameras() const { return heard_.size(); }  ///< of which sources are known

 private:
  struct Source {
    double last_heard = 0;  // [s]
    int64_t seq = -1;
    std::optional<int64_t> fell_from;  // the last number before seq fell
    bool fell_to_itself = false;       // the number was repeated
    std::deque<double> returns;        // times at which the numbers of before the fall went on [s]
  };
  using Sources = std::map<std::string, Source>;
  static bool AddNumber(int64_t seq, double now, Source* source);
  void ForgetSilent(double now, Sources* sources);
  void ForgetAllSilent(double now);

  std::map<CameraId, Sources> heard_;  // has at most kMaxSources cameras
  size_t size_ = 0;                    // sources of all cameras
};

/// Whether `finding` is a sentence of CameraSources about frames of this source.
bool IsAboutSharedCamera(const std::string& finding, const std::string& source);

}  // namespace vismap
