#include "segmentation/pixel_ownership.h"

#include <utility>

#include "segmentation/mask_sets.h"

namespace vismap {
namespace {

std::vector<DetectionIndex> RankDetections(const DetectionSet& set, double min_score) {
  std::vector<DetectionIndex> ranking;
  std::vector<int32_t> area;
  for (size_t k = 0; k < set.detections.size(); ++k) {
    area.push_back(MaskArea(set.detections[k].mask));
    if (set.detections[k].score >= min_score) ranking.push_back(static_cast<DetectionIndex>(k));
  }
  std::stable_sort(ranking.begin(), ranking.end(), [&](DetectionIndex i, DetectionIndex j) {
    const float score_a = set.detections[At(i)].score, score_b = set.detections[At(j)].score;
    return score_a != score_b ? score_a > score_b : area[At(i)] < area[At(j)];
  });
  return ranking;
}

/// Whether two detections are of one thing: of one class, of similar size, and more than
/// `same_part` of the smaller mask lies in the larger one.
bool AreDuplicates(const Detection& a, const Detection& b, double same_part) {
  constexpr int kMaxRatio = 3;  // a much smaller mask may be a thing on or beside one of its class
  if (a.class_id != b.class_id || same_part >= 1) return false;
  const int32_t area_a = MaskArea(a.mask), area_b = MaskArea(b.mask);
  const int32_t small = std::min(area_a, area_b);
  return kMaxRatio * small >= std::max(area_a, area_b) &&
         SharedArea(a.mask, b.mask) > same_part * small;
}

}  // namespace

PixelOwnership::PixelOwnership(const DetectionSet& set, const RefineOptions& options, int width,
                               int height)
    : set_(&set), width_(width), height_(height), ranking_(RankDetections(set, options.min_score)) {
  if (!options.resolve_overlaps) return;  // masks share pixels, and no two are joined
  JoinDuplicates(options.same_part);
  AssignPixels();
}

void PixelOwnership::JoinDuplicates(double same_part) {
  std::vector<DetectionIndex> leaders;
  for (const DetectionIndex k : ranking_) {
    const auto leader = std::find_if(leaders.begin(), leaders.end(), [&](DetectionIndex better) {
      return AreDuplicates(detection(better), detection(k), same_part);
    });
    if (leader == leaders.end()) {
      leaders.push_back(k);
    } else {
      joined_masks_[*leader] = UnionOf(MaskOf(*leader), detection(k).mask);
    }
  }
  ranking_ = std::move(leaders);  // the worse duplicates are not used any more
}

void PixelOwnership::AssignPixels() {
  owner_ = Image<DetectionIndex>(width_, height_, DetectionIndex::kNone);
  const auto assign = [&](const Mask& mask, DetectionIndex k) {
    ForMask(mask, width_, height_, [&](int v, int u) { owner_(v, u) = k; });
  };
  // What is assigned later wins. Joined masks come first, so that a duplicate with too large a mask
  // gets no pixel of another thing's own mask. Then the detections' own masks, the best one last.
  for (const auto& [k, mask] : joined_masks_) assign(mask, k);
  for (auto k = ranking_.rbegin(); k != ranking_.rend(); ++k) assign(detection(*k).mask, *k);
}

}  // namespace vismap
