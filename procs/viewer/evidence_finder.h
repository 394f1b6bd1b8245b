#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/evidence_store.h"
#include "viewer/object_mask.h"

namespace vismap {

/// An object of the map, as a page asks for it.
struct EvidenceQuestion {
  SurfaceBlocks blocks;  ///< of the whole map
  std::string map_id;
  int64_t revision = -1;
  ObjectChoice object;
  bool of_log = false;  ///< at a moment of a log: the revision is the number of its frames
};

/// The object's mask over a frame, with every `step`-th pixel of the frame.
struct FrameMask {
  ObjectMask mask;
  int step = 1;
  int detection = -1;  ///< of the detection that covers nearly the same pixels; -1 = none
  double overlap = 0;  ///< intersection of both over their union, [0, 1]
  ClassId class_id = ClassId::kUnknown;  ///< of that detection
  float score = 0;                       ///< of that detection
  /// Share of the object's pixels in the picture in which it is seen, [0, 1].
  double share() const {
    return mask.pixels_alone == 0 ? 0 : static_cast<double>(mask.pixels) / mask.pixels_alone;
  }
};

/// A frame in which an object is seen.
struct EvidenceView {
  EvidenceFramePtr frame;
  std::shared_ptr<const FrameMask> mask;
  int64_t pixels = 0;  ///< of the picture, about
  double whole = 0;    ///< share of the object's surface that lies within the picture, [0, 1]
};

/// Finds the frames in which objects are seen. For one thread.
class EvidenceFinder {
 public:
  static constexpr size_t kMostViews = 12;
  static constexpr int kMaskColumns = 320;    ///< at most
  static constexpr int kLeastPixels = 24;     ///< of a mask
  static constexpr double kLeastShare = 0.3;  ///< of the object that must be seen
  static constexpr double kMostTime = 5;      ///< [s] after which no further mask is drawn
  static constexpr size_t kMostMasks = 48;    ///< that are remembered

  static constexpr double kMaskKept = 10;  ///< [s] also when the map has changed

  explicit EvidenceFinder(size_t max_bytes, double mask_kept = kMaskKept)
      : store_(max_bytes), mask_kept_(mask_kept) {}
  EvidenceStore& store() { return store_; }

  /// Views of the object from different places. First those that show the most pixels of it with
  /// the least of it outside of the picture. nullopt = the object has no surface.
  std::optional<std::vector<EvidenceView>> Find(const EvidenceQuestion& question);
  /// A mask that was drawn less than `mask_kept` ago is not drawn again [s].
  std::shared_ptr<const FrameMask> MaskOf(const EvidenceQuestion& question,
                                          const EvidenceFramePtr& frame);

 private:
  struct Known {
    EvidenceFramePtr frame;
    std::string map_id;
    int64_t revision = -1;
    ObjectChoice object;
    double time = 0;  // MonotonicSeconds
    std::shared_ptr<const FrameMask> mask;
  };
  EvidenceStore store_;
  double mask_kept_;
  std::deque<Known> known_;  // the newest last
};

/// Pixels of a detection of the frame, at the size of the frame; fails when its segments cannot be
/// decoded.
Result<Image<uint8_t>> DetectionMask(const EvidenceFrame& frame, int detection);

}  // namespace vismap
