#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "foreign/frame_joiner.h"

namespace vismap {

/// One FrameJoiner for each camera of a robot; all of them get the same messages, so that a camera
/// that lacks something does not delay the others.
class CameraJoiners {
 public:
  /// Gets the frames; `camera` is the place in the list of cameras.
  using Sink = std::function<void(size_t camera, ForeignFrame&&)>;

  /// For cameras with their presets. Fails as CheckComplete and FrameJoiner::Create do. For
  /// `keep_pixels` see there.
  static Result<CameraJoiners> Create(const std::vector<AdapterCameraOptions>& cameras,
                                      const Sink& sink, bool keep_pixels = true);

  /// As FrameJoiner::Add, Advance, Finish and SetWallOffset.
  Result<void> Add(const std::string& channel, std::span<const uint8_t> bytes, int64_t received,
                   int64_t number = -1);
  void Advance(int64_t now);
  void Finish();
  void SetWallOffset(int64_t offset);

  /// Sums over the cameras.
  int64_t frames() const;
  int64_t waiting() const;
  int64_t dropped() const;
  /// What was dropped and why; with several cameras each part names its camera. "" = nothing.
  std::string DroppedText() const;
  /// The same for poses and times that were ignored.
  int64_t ignored() const;
  std::string IgnoredText() const;

  const std::vector<FrameJoiner>& cameras() const { return joiners_; }

 private:
  using Counts = const ReasonCounts& (FrameJoiner::*)() const;
  std::string TextOf(Counts counts) const;

  std::vector<FrameJoiner> joiners_;
};

/// "camera 3".
std::string CameraName(const AdapterCameraOptions& camera);

}  // namespace vismap
