#pragma once

#include <cstdint>
#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "codecs/frame_codec.h"
#include "segmentation/segment_frame.h"
#include "support/mutations.h"
#include "wire/rgbd_frame.h"
#include "wire/segmented_frame.h"

namespace vismap::hostile {

/// A frame of 160x120 pixels that looks along +z onto a wall 1.5 m away, without colour.
inline SensorFrame Wall(int64_t utime, const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) {
  SensorFrame frame;
  frame.header.utime = utime;
  frame.header.camera = {160, 120, 130, 130, 79.5, 59.5};
  frame.header.T_W_C.translation() = position;
  frame.depth = Image<uint16_t>(160, 120, 1500);
  return frame;
}

/// The same with a random depth up to 5 m in every pixel.
inline SensorFrame Noise(int64_t utime, uint64_t seed, int width = 160, int height = 120) {
  SensorFrame frame = Wall(utime);
  frame.header.camera = {width, height, 0.8 * width, 0.8 * width, width / 2.0, height / 2.0};
  frame.depth = Image<uint16_t>(width, height);
  TestRandom random(seed);
  for (uint16_t& depth : frame.depth.pixels())
    depth = static_cast<uint16_t>(200 + random.Below(4800));
  return frame;
}

/// The SEGMENTED_FRAME of a frame.
inline segmented_frame_t Segmented(const SensorFrame& frame, int64_t after_utime = -1) {
  rgbd_frame_t message = Encode(frame);
  message.after_utime = after_utime;
  return Encode(SegmentFrame(*DecodeFrame(frame), nullptr, {}), message);
}

}  // namespace vismap::hostile
