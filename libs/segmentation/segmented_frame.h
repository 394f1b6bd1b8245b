#pragma once

#include <vector>

#include "base/ids.h"
#include "geometry/frame.h"
#include "segmentation/detections.h"

namespace vismap {

/// The pixels [begin, end) of row v, which belong to a loose piece.
struct LooseRun {
  int32_t v = 0, begin = 0, end = 0;
  int32_t piece = 0;  ///< 0, 1, ... by the piece's first pixel in row order
  friend bool operator==(const LooseRun&, const LooseRun&) = default;
};

/// HxW of SegmentIndex (0..n-1, kNone where no segment); dies with the frame.
struct SegmentImage {
  Image<SegmentIndex> index;
  int segment_count = 0;
  /// Not 0 where a fold made geometry guess to which of two segments the pixel belongs; may be
  /// empty. Refinement lets masks decide there; it does not travel.
  Image<uint8_t> ambiguous{};
  /// Connected pieces too small to be segments, row by row from left to right: the legs of a chair,
  /// say. `index` has them as specks of a neighbour, or as none. Refinement lets masks decide; they
  /// do not travel.
  std::vector<LooseRun> loose{};
};

/// What is known of one segment of a frame.
struct FrameSegment {
  int32_t pixels = 0;  ///< its size in the image
  DetectionIndex detection =
      DetectionIndex::kNone;             ///< the detection it belongs to (the paper's o_i)
  ClassId class_id = ClassId::kUnknown;  ///< of that detection (the paper's c_i)
  float score = 0;                       ///< of that detection, [0, 1]
  float overlap = 0;                     ///< |region in mask| / |region| (the paper's p_i), [0, 1]
  friend bool operator==(const FrameSegment&, const FrameSegment&) = default;
};

/// A frame cut into segments, each with at most one detection: all that association and integration
/// need.
struct SegmentedFrame {
  RgbdFrame frame;
  SegmentImage image;
  std::vector<FrameSegment> segments;  ///< indexed by SegmentIndex
  bool had_detections = false;  ///< a detector looked at this frame, even if it found nothing
};

}  // namespace vismap
