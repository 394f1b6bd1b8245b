#include "segmentation/fold_pixels.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "segmentation/at.h"

namespace vismap {
namespace {

struct Pixel {
  int v, u;
};

bool OnOneSurface(const Image<float>& depth, Pixel p, Pixel q) {
  // Of the depth, between neighbouring pixels: steps are smaller on a fold and larger at a jump.
  constexpr float kMaxStep = 0.02F;
  const float a = depth(p.v, p.u), b = depth(q.v, q.u);
  return std::abs(a - b) <= kMaxStep * std::min(a, b);
}

/// Grows the segments of one detection over fold pixels.
class FoldGrowth {
 public:
  FoldGrowth(DetectionIndex k, const PixelOwnership& ownership, SegmentedFrame* frame)
      : k_(k), ownership_(ownership), frame_(*frame) {}

  void Grow() {
    std::vector<Pixel> front;  // pixels of the object on folds; grows while it is read
    ownership_.ForPixelsOf(k_, [&](int v, int u) {
      if (IsFold(v, u) && IsOfObject(frame_.image.index(v, u))) front.push_back({v, u});
    });
    for (size_t next = 0; next < front.size(); ++next) {
      const auto [v, u] = front[next];
      for (const Pixel q : {Pixel{v, u + 1}, {v + 1, u}, {v, u - 1}, {v - 1, u}}) {
        if (!MayGrow({v, u}, q)) continue;
        Move(q, frame_.image.index(v, u));
        front.push_back(q);
      }
    }
  }

 private:
  bool IsFold(int v, int u) const { return frame_.image.edge_strength(v, u) > kBesideJump; }
  FrameSegment& SegmentOf(SegmentIndex index) const { return frame_.segments[At(index)]; }
  bool IsOfObject(SegmentIndex index) const {
    return index != SegmentIndex::kNone && SegmentOf(index).detection == k_;
  }

  /// Whether pixel q beside pixel p of the object joins it.
  bool MayGrow(Pixel p, Pixel q) const {
    const Image<SegmentIndex>& image = frame_.image.index;
    if (!image.Contains(q.v, q.u) || !IsFold(q.v, q.u) || !ownership_.Owns(k_, q.v, q.u))
      return false;
    if (image(q.v, q.u) == SegmentIndex::kNone || !OnOneSurface(frame_.frame.depth, p, q))
      return false;
    // Pixels of other objects and of this one stay, and no segment loses its last pixel.
    const FrameSegment& loser = SegmentOf(image(q.v, q.u));
    return loser.detection == DetectionIndex::kNone && loser.pixels > 1;
  }

  void Move(Pixel q, SegmentIndex to) {
    SegmentIndex& index = frame_.image.index(q.v, q.u);
    --SegmentOf(index).pixels;
    ++SegmentOf(to).pixels;
    index = to;
  }

  const DetectionIndex k_;
  const PixelOwnership& ownership_;
  SegmentedFrame& frame_;
};

}  // namespace

SegmentedFrame AssignFoldPixels(SegmentedFrame frame, const PixelOwnership& ownership,
                                double min_score) {
  for (const DetectionIndex k : ownership.ranking()) {
    if (ownership.detection(k).score >= min_score) FoldGrowth(k, ownership, &frame).Grow();
  }
  return frame;
}

}  // namespace vismap
