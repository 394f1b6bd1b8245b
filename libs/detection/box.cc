#include "detection/box.h"

#include <algorithm>
#include <tuple>

namespace vismap {
namespace {

float Area(const Box& box) {
  return std::max(0.0f, box.u1 - box.u0) * std::max(0.0f, box.v1 - box.v0);
}

}  // namespace

float Overlap(const Box& a, const Box& b) {
  const Box shared{std::max(a.u0, b.u0), std::max(a.v0, b.v0), std::min(a.u1, b.u1),
                   std::min(a.v1, b.v1)};
  const float both = Area(shared);
  const float any = Area(a) + Area(b) - both;
  return any > 0 ? both / any : 0;
}

std::vector<Candidate> SuppressOverlaps(std::vector<Candidate> candidates, float max_iou,
                                        int max_count) {
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tuple(-a.score, a.source, a.class_index) <
           std::tuple(-b.score, b.source, b.class_index);
  });
  std::vector<Candidate> kept;
  for (const Candidate& candidate : candidates) {
    if (static_cast<int>(kept.size()) >= max_count) break;
    // A kept candidate of the same class covers it.
    const bool hidden = std::any_of(kept.begin(), kept.end(), [&](const Candidate& stronger) {
      return stronger.class_index == candidate.class_index &&
             Overlap(stronger.box, candidate.box) > max_iou;
    });
    if (!hidden) kept.push_back(candidate);
  }
  return kept;
}

}  // namespace vismap
