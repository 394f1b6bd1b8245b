#pragma once

#include <functional>
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

/// The colour of a frame as JPEG, also when it came in another encoding.
Result<std::vector<uint8_t>> JpegOf(const rgbd_frame_t& frame);

/// The message of kind 2 for a frame, see procs/README.md: its colour as JPEG, and its segments
/// with their detections over a sampled image. What cannot be decoded is told in the JSON.
std::vector<uint8_t> MakePicture(const segmented_frame_t& message);

/// Cameras and pictures from SEGMENTED_FRAME. Frames are large, so they come over a bus of its own,
/// which is read only a few times per second: frames in between are not decoded.
class CameraWatch {
 public:
  static constexpr size_t kMostCameras = 64;
  /// Gets every frame that is decoded.
  using Sink = std::function<void(const std::shared_ptr<const segmented_frame_t>&)>;

  struct Rates {
    double page_hz = 5;  ///< at which the bus is read while a page is connected
    double idle_hz = 0;  ///< and otherwise; 0 = then it is not joined
  };
  /// `bus_options`: how it joins. `board` must outlive it.
  CameraWatch(BusOptions bus_options, Rates rates, Board* board, Sink sink);

  /// Reads when it is due at time `now` [s]. `pages`: whether a page is connected; `pictures`: of
  /// which cameras pages show pictures.
  void Poll(double now, bool pages, const std::set<int>& pictures);
  bool joined() const { return bus_ != nullptr; }

 private:
  struct Camera {
    CameraView view;
    std::shared_ptr<const segmented_frame_t> newest;  // nullptr with too many cameras
    int64_t pictured_utime = -1;                      // of the frame that the board's picture shows
  };
  Result<void> OnFrame(const segmented_frame_t& message);
  void Join(double now);
  void Read();
  void MakePictures(const std::set<int>& pictures);

  BusOptions bus_options_;
  Rates rates_;
  Board* board_;
  Sink sink_;
  std::unique_ptr<Bus> bus_;
  double next_join_ = 0, next_read_ = 0;
  bool had_pages_ = false;
  std::map<int, Camera> cameras_;  // by id
  bool changed_ = false;
};

}  // namespace vismap
