#pragma once

#include <deque>
#include <string>
#include <vismap/frame_commit_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "map_server/camera_clocks.h"
#include "map_server/frame_intake.h"
#include "map_server/live_map.h"
#include "map_server/map_check.h"
#include "runtime/bus.h"
#include "runtime/frame_lag.h"
#include "runtime/status.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Integrates SEGMENTED_FRAMEs into a map, in the order that their source asks for, and answers
/// each with a MAP_COMMIT. No frame is integrated twice. With Overload::kNewest it drops frames
/// when newer ones are ready. STATUS has how far the map is behind the cameras. STATUS has what is
/// suspect about the frames and which of them were left out (MapCheck).
class FrameMapper {
 public:
  /// Subscribes to SEGMENTED_FRAME. All but the config must outlive it.
  FrameMapper(LiveMap* map, const VismapConfig& config, Bus* bus, Status* status);
  FrameMapper(const FrameMapper&) = delete;
  FrameMapper& operator=(const FrameMapper&) = delete;

  /// Integrates one frame that is ready. Only needed with Overload::kNewest: else frames are
  /// integrated when they arrive. Returns false when there is none.
  Result<bool> MapNext();
  /// The share of the time that each kind of work beside the frames may take: the usual one, or
  /// less while the map is behind the cameras.
  double side_share() const { return behind_ ? kShareWhenBehind : kUsualShare; }
  bool has_ready() const { return !ready_.empty(); }
  /// What became of the frames of this process: one sentence.
  std::string Summary() const;

 private:
  Result<void> OnFrame(const segmented_frame_t& message);
  void CollectReady();
  void DropBeyondLimits();
  void TellLag();
  void TellFarParts();
  Result<void> MapMessage(segmented_frame_t message);
  Result<SegmentedFrame> DecodeAndFill(const segmented_frame_t& message) const;
  frame_commit_t MapOrRefuse(const segmented_frame_t& message, const SegmentedFrame& frame);
  void Skip(const segmented_frame_t& message, const std::string& reason);
  void Refuse(const segmented_frame_t& message, const std::string& reason, frame_commit_t* commit);
  void MarkSkipped(const segmented_frame_t& message, const std::string& reason,
                   frame_commit_t* commit);
  void CheckClock(const FrameKey& frame);
  bool Contains(const FrameKey& frame) const;

  LiveMap& map_;
  Bus& bus_;
  Status& status_;
  Overload overload_;
  std::deque<segmented_frame_t> ready_;  // wait for no other frame
  FrameLag lag_;
  bool behind_ = false;                  // so far that STATUS tells
  FollowerPosition far_parts_position_;  // of the map, when they were told last
  HoldLimits limits_;                    // of the frames that wait
  FrameIntake intake_;
  CameraClocks clocks_;
  MapCheck check_;
};

}  // namespace vismap
