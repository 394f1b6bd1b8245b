#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "segmentation/at.h"
#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Calls visit(v, u) for the pixels of a mask that lie inside an image, in row order.
template <typename Visit>
void ForMask(const Mask& mask, int width, int height, const Visit& visit) {
  for (int y = std::max(0, -mask.v0); y < std::min(mask.inside.height(), height - mask.v0); ++y) {
    const uint8_t* inside = mask.inside.row(y);
    for (int x = std::max(0, -mask.u0); x < std::min(mask.inside.width(), width - mask.u0); ++x) {
      if (inside[x]) visit(y + mask.v0, x + mask.u0);
    }
  }
}

/// The detections of one frame that the refinement uses, and the pixels that belong to each.
///
/// Detections below RefineOptions::min_score are not used. With RefineOptions::resolve_overlaps,
/// duplicates are joined (see `same_part`), and a pixel in several masks belongs to the best
/// detection only; otherwise it belongs to all of them.
class PixelOwnership {
 public:
  /// `set` must outlive this. The image has `width` x `height` pixels; masks are cut at its border.
  PixelOwnership(const DetectionSet& set, const RefineOptions& options, int width, int height);

  /// The detections in use, best first: by score, then smaller mask, then lower index.
  const std::vector<DetectionIndex>& ranking() const { return ranking_; }
  /// How many detections the frame has, used or not.
  size_t detection_count() const { return set_->detections.size(); }
  const Detection& detection(DetectionIndex k) const { return set_->detections[At(k)]; }
  /// The mask of a detection, united with those of its duplicates.
  const Mask& MaskOf(DetectionIndex k) const {
    const auto joined = joined_masks_.find(k);
    return joined != joined_masks_.end() ? joined->second : detection(k).mask;
  }
  /// Whether a pixel may belong to several detections.
  bool is_shared() const { return owner_.empty(); }
  /// Whether pixel (v, u) of the image belongs to detection k.
  bool Owns(DetectionIndex k, int v, int u) const {
    return is_shared() ? MaskOf(k).Contains(v, u) : owner_(v, u) == k;
  }
  /// Calls visit(v, u) for the pixels that belong to detection k, in row order.
  template <typename Visit>
  void ForPixelsOf(DetectionIndex k, const Visit& visit) const {
    ForMask(MaskOf(k), width_, height_, [&](int v, int u) {
      if (is_shared() || owner_(v, u) == k) visit(v, u);
    });
  }
  /// Calls visit(k) for the detections that pixel (v, u) of the image belongs to, best first.
  template <typename Visit>
  void ForOwnersOf(int v, int u, const Visit& visit) const {
    if (!is_shared()) {
      if (owner_(v, u) != DetectionIndex::kNone) visit(owner_(v, u));
      return;
    }
    for (const DetectionIndex k : ranking_) {
      if (detection(k).mask.Contains(v, u)) visit(k);
    }
  }

 private:
  void JoinDuplicates(double same_part);
  void AssignPixels();

  const DetectionSet* set_;
  int width_, height_;
  std::vector<DetectionIndex> ranking_;
  std::map<DetectionIndex, Mask> joined_masks_;  ///< of detections that have duplicates
  Image<DetectionIndex> owner_;                  ///< empty = pixels are shared
};

}  // namespace vismap
