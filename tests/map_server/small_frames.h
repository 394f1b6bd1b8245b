#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vismap/segmented_frame_t.hpp>

#include "codecs/frame_codec.h"
#include "runtime/bus.h"
#include "segmentation/segment_frame.h"
#include "session/map_session.h"
#include "support/messages.h"
#include "wire/rgbd_frame.h"
#include "wire/segmented_frame.h"

namespace vismap::testing_support {

inline std::unique_ptr<Bus> MemoryBus() { return std::move(*Bus::Open({"memq://", "test"})); }

inline FrameKey Key(int32_t camera, int64_t utime) { return {CameraId{camera}, utime}; }

inline FrameKey SmallKey(int64_t utime) { return {CameraId{3}, utime}; }

/// A small frame of camera 3, as SEGMENTED_FRAME brings it; to be integrated after `after_utime`.
inline segmented_frame_t SmallMessage(int64_t utime, int64_t after_utime = -1) {
  const SensorFrame sensor = SmallSensorFrame(utime);
  rgbd_frame_t message = Encode(sensor);
  message.after_utime = after_utime;
  return Encode(SegmentFrame(*DecodeFrame(sensor), nullptr, {}), message);
}

inline MapSessionOptions CoarseMap() {
  MapSessionOptions options;
  options.grid = VoxelGridOptions{0.05, 4};
  return options;
}

}  // namespace vismap::testing_support
