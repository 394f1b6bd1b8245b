#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>
#include <vismap/segmented_frame_t.hpp>

#include "base/ids.h"
#include "base/result.h"
#include "geometry/frame.h"
#include "geometry/image.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// A frame that is kept, so that pages can show what objects looked like in it.
struct EvidenceFrame {
  /// What a detector said of a segment of the frame.
  struct Segment {
    int32_t detection = -1;  ///< -1 = none
    ClassId class_id = ClassId::kUnknown;
    float score = 0;
  };
  FrameHeader header;
  std::vector<uint8_t> jpeg;
  /// Every `depth_step`-th pixel of the depth image [mm]; 0 = not measured.
  Image<uint16_t> depth_mm;
  int depth_step = 1;
  std::vector<uint8_t> labels;    ///< the segment image, see label_codec.h
  std::vector<Segment> segments;  ///< by the values of the segment image
  int64_t map_frames = 0;         ///< of a log: of the map that had this one as its newest

  size_t bytes() const;  ///< memory, about
};
using EvidenceFramePtr = std::shared_ptr<const EvidenceFrame>;

/// Fails when the frame has no colour, or something of it cannot be decoded.
Result<EvidenceFramePtr> MakeEvidenceFrame(const segmented_frame_t& message);
/// The same of a frame that was no message. `labels`: see EvidenceFrame.
std::shared_ptr<EvidenceFrame> MakeEvidenceFrame(const SegmentedFrame& frame,
                                                 std::vector<uint8_t> jpeg,
                                                 std::vector<uint8_t> labels);

/// How different the places and directions of two views are: 1 = 25 cm or 20 degrees, or as much in
/// sum.
double ViewDistance(const FrameHeader& a, const FrameHeader& b);

/// Frames within a bound of memory, whose views differ by at least `distance()`. When the memory is
/// full, that distance grows, and frames that are too close to newer ones are dropped. So the
/// frames are spread over the places and directions of the cameras, and of every object those views
/// stay that differ most. A frame takes the place of those that it is close to when they are older
/// than `renew_after`.
class EvidenceStore {
 public:
  static constexpr double kFirstDistance = 0.2;  ///< while there is room
  static constexpr size_t kMostFrames = 4096;
  static constexpr int64_t kRenewAfter = 60000000;  ///< [us]

  /// `renew_after` [us].
  explicit EvidenceStore(size_t max_bytes, int64_t renew_after = kRenewAfter)
      : max_bytes_(max_bytes), renew_after_(renew_after) {}

  /// Whether a frame with this header would be kept.
  bool Wants(const FrameHeader& header) const;
  /// Keeps the frame if it wants it.
  void Add(EvidenceFramePtr frame);
  void Clear();
  /// Without the frames of which EvidenceFrame::map_frames is larger.
  EvidenceStore Until(int64_t map_frames) const;

  /// nullptr when it is not kept.
  EvidenceFramePtr Find(CameraId camera, int64_t utime) const;
  /// From the oldest to the newest that was added.
  const std::vector<EvidenceFramePtr>& frames() const { return frames_; }
  size_t bytes() const { return bytes_; }
  double distance() const { return distance_; }

 private:
  void Thin();

  size_t max_bytes_, bytes_ = 0;
  int64_t renew_after_;
  double distance_ = kFirstDistance;
  std::vector<EvidenceFramePtr> frames_;
};

}  // namespace vismap
