#pragma once

#include <cstdint>
#include <string>

#include "base/reason_counts.h"
#include "plausibility/sequence_check.h"
#include "runtime/status.h"
#include "session/map_session.h"
#include "wire/frame_key.h"

namespace vismap {

/// Watches the frames of the map and tells in STATUS what is suspect about them (SequenceCheck),
/// and which frames were left out and why.
class MapCheck {
 public:
  /// `status` must outlive it.
  MapCheck(const DepthLimits& limits, Status* status) : limits_(limits), status_(status) {}

  /// Frames go into this map from now on. If it is another one than before, everything is
  /// forgotten.
  void SetMap(const std::string& map_id);
  /// A frame that went into the map. `depth_unit_m` is that of its depth image, `input_digest` that
  /// of its message (DigestInput).
  void Integrated(const SegmentedFrame& frame, double depth_unit_m,
                  const std::string& input_digest);
  /// A frame that cannot be used.
  void Skipped(const std::string& reason);
  /// A frame whose camera and utime the map has already. It is only suspect if it is not the same
  /// frame that was sent again.
  void Duplicate(const FrameHeader& header, const std::string& input_digest,
                 const MapSession& session);

 private:
  static constexpr int64_t kFirstCheck = 2;  // then at twice as many frames

  void UpdateLeftOut();

  DepthLimits limits_;
  Status* status_;
  std::string map_id_;
  SequenceCheck sequence_{limits_};
  int64_t frames_ = 0;                // integrated into this map
  int64_t next_check_ = kFirstCheck;  // the number of frames at which the sequence is judged next
  ReasonCounts left_out_;
  FrameKey last_;            // the last frame that was integrated
  std::string last_digest_;  // of its message
};

}  // namespace vismap
