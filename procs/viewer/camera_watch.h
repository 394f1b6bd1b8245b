#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>
#include <vismap/segmented_frame_t.hpp>

#include "base/result.h"
#include "runtime/bus.h"
#include "viewer/board.h"

namespace vismap {

/// The message of kind 2 for a frame, see procs/README.md: its colour as JPEG, and its segments
/// with their detections over a sampled image. What cannot be decoded is told in the JSON.
std::vector<uint8_t> MakePicture(const segmented_frame_t& message);

/// Cameras and pictures from SEGMENTED_FRAME. Frames are large, so a bus of its own is joined only
/// while a page is connected, and it is read only a few times per second: frames in between are not
/// decoded.
class CameraWatch {
 public:
  static constexpr size_t kMostCameras = 64;

  /// `bus_options`: how it joins. `board` must outlive it.
  CameraWatch(BusOptions bus_options, double max_hz, Board* board);

  /// Reads when it is due at time `now` [s]. `pages`: whether a page is connected; `pictures`: of
  /// which cameras pages show pictures.
  void Poll(double now, bool pages, const std::set<int>& pictures);
  bool joined() const { return bus_ != nullptr; }

 private:
  Result<void> OnFrame(const segmented_frame_t& message);
  void Join(double now);

  BusOptions bus_options_;
  double period_;  // [s]
  Board* board_;
  std::unique_ptr<Bus> bus_;
  double next_join_ = 0, next_read_ = 0;
  std::set<int> pictures_;
  std::map<int, CameraView> cameras_;  // by id
  bool changed_ = false;
};

}  // namespace vismap
