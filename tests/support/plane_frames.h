#pragma once

#include <cmath>
#include <limits>

#include "segmentation/segmented_frame.h"

namespace vismap::testing_support {

/// A camera of 160x120 pixels with a wide view.
inline PinholeCamera SmallCamera() { return {160, 120, 130.0, 130.0, 79.5, 59.5}; }

/// A frame that looks along +z of W from `position` onto the plane z = `wall` [m], as one segment
/// of `color`.
inline SegmentedFrame LookAtWall(double wall,
                                 const Eigen::Vector3d& position = Eigen::Vector3d::Zero(),
                                 Rgb8 color = {200, 100, 50}) {
  SegmentedFrame frame;
  FrameHeader& header = frame.frame.header;
  header.camera = SmallCamera();
  header.T_W_C.translation() = position;
  const int w = header.camera.width, h = header.camera.height;
  frame.frame.depth = Image<float>(w, h, static_cast<float>(wall - position.z()));
  frame.frame.color = Image<Rgb8>(w, h, color);
  frame.image.index = Image<SegmentIndex>(w, h, SegmentIndex{0});
  frame.image.segment_count = 1;
  frame.segments.resize(1);
  frame.segments[0].pixels = w * h;
  return frame;
}

/// Splits the frame's image into two segments at column `u_split`: 0 on the left, 1 on the right.
inline void SplitAtColumn(int u_split, SegmentedFrame& frame) {
  frame.image.segment_count = 2;
  frame.segments.assign(2, FrameSegment{});
  for (int v = 0; v < frame.image.index.height(); ++v) {
    for (int u = 0; u < frame.image.index.width(); ++u) {
      frame.image.index(v, u) = u < u_split ? SegmentIndex{0} : SegmentIndex{1};
    }
  }
  frame.segments[0].pixels = u_split * frame.image.index.height();
  frame.segments[1].pixels = (frame.image.index.width() - u_split) * frame.image.index.height();
}

inline void Detect(int segment, int detection, ClassId class_id, SegmentedFrame& frame) {
  FrameSegment& record = frame.segments[static_cast<size_t>(segment)];
  record.detection = static_cast<DetectionIndex>(detection);
  record.class_id = class_id;
  record.score = 1;
  record.overlap = 1;
  frame.had_detections = true;
}

}  // namespace vismap::testing_support
