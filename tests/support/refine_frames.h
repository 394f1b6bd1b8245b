#pragma once

#include <utility>
#include <vector>

#include "segmentation/segmented_frame.h"

namespace vismap::testing_support {

// A small frame for the tests of the refinement and of its steps.

inline constexpr int kWidth = 200, kHeight = 150;
inline constexpr ClassId kCup{47}, kTable{67}, kChair{62};

/// All pixels at 1 m.
inline RgbdFrame Frame() {
  RgbdFrame frame;
  frame.header.camera = {kWidth, kHeight, 200, 200, 100, 75};
  frame.depth = Image<float>(kWidth, kHeight, 1.0F);
  return frame;
}

/// Two segments: 0 = columns below 100, 1 = the rest. The top ten rows belong to none.
inline SegmentImage Halves() {
  SegmentImage image{Image<SegmentIndex>(kWidth, kHeight, SegmentIndex::kNone), 2};
  for (int v = 10; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) image.index(v, u) = static_cast<SegmentIndex>(u < 100 ? 0 : 1);
  }
  return image;
}

/// A detection with a rectangular mask.
inline Detection Rectangle(ClassId class_id, float score, int u0, int v0, int width, int height) {
  Detection detection{class_id, score, {}};
  detection.mask.image_width = kWidth;
  detection.mask.image_height = kHeight;
  detection.mask.u0 = u0;
  detection.mask.v0 = v0;
  detection.mask.inside = Image<uint8_t>(width, height, uint8_t{1});
  return detection;
}

inline DetectionSet Set(std::vector<Detection> detections) {
  DetectionSet set;
  set.detections = std::move(detections);
  return set;
}

}  // namespace vismap::testing_support
