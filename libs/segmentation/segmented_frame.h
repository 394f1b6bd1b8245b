#pragma once

#include <vector>

#include "base/ids.h"
#include "geometry/frame.h"
#include "segmentation/detections.h"

namespace vismap {

/// The pixels [begin, end) of row v, which belong to a loose piece: a connected piece of a surface
/// that is too small to be a segment, such as the leg of a chair.
struct LooseRun {
  int32_t v = 0, begin = 0, end = 0;
  int32_t piece = 0;  ///< 0, 1, ... by the piece's first pixel in row order
  friend bool operator==(const LooseRun&, const LooseRun&) = default;
};

/// Value of SegmentImage::edge_strength beside a depth jump. Larger values are on concave folds and
/// grow with the angle; 0 is inside a surface.
inline constexpr uint8_t kBesideJump = 1;

/// The segments of one depth image.
struct SegmentImage {
  Image<SegmentIndex> index;  ///< HxW: 0..segment_count - 1, kNone where there is no segment
  int segment_count = 0;
  /// HxW; may be empty. On a fold, geometry decides only roughly to which of two segments a pixel
  /// belongs, so the refinement lets masks decide. Not part of messages.
  Image<uint8_t> edge_strength{};
  /// All loose pieces, row by row from left to right. In `index` they belong to a neighbour or to
  /// no segment; the refinement lets masks decide. Not part of messages.
  std::vector<LooseRun> loose{};
};

/// One segment of a frame.
struct FrameSegment {
  int32_t pixels = 0;  ///< its size in the image
  DetectionIndex detection =
      DetectionIndex::kNone;             ///< the detection it belongs to (the paper's o_i)
  ClassId class_id = ClassId::kUnknown;  ///< of that detection (the paper's c_i)
  float score = 0;                       ///< of that detection, [0, 1]
  float overlap = 0;                     ///< |region in mask| / |region| (the paper's p_i), [0, 1]
  friend bool operator==(const FrameSegment&, const FrameSegment&) = default;
};

/// A frame cut into segments, each with at most one detection. Association and integration need
/// nothing else of a frame.
struct SegmentedFrame {
  RgbdFrame frame;
  SegmentImage image;
  std::vector<FrameSegment> segments;  ///< indexed by SegmentIndex
  bool had_detections = false;  ///< a detector processed this frame, even if it found nothing
};

}  // namespace vismap
