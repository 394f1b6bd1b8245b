#include "viewer/evidence_finder.h"

#include <algorithm>
#include <map>
#include <utility>

#include "codecs/label_codec.h"
#include "runtime/clock.h"

namespace vismap {
namespace {

constexpr size_t kSamples = 400;    // points of an object's surface
constexpr size_t kCandidates = 18;  // frames whose masks are drawn
constexpr double kEnoughDistance =
    4;  // of two views that are as good as any others, see ViewDistance
constexpr double kLeastOverlap = 0.3;  // of a detection that is said to be the object's

struct ViewCandidate {
  EvidenceFramePtr frame;
  double pixels = 0;   // in proportion to the area that is seen
  double whole = 0;    // share of the points that are in the picture, also hidden ones
  double novelty = 1;  // [0, 1]
  double value() const { return pixels * whole * (0.15 + 0.85 * novelty); }
};

// How much of the points a frame shows, by what its depth camera measured.
ViewCandidate Estimate(const EvidenceFramePtr& frame, const std::vector<Eigen::Vector3f>& points) {
  ViewCandidate candidate{frame};
  const PinholeCamera& camera = frame->header.camera;
  const Pose T_C_W = frame->header.T_W_C.inverse();
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p_C = T_C_W * point.cast<double>();
    if (!(p_C.z() > 0.05)) continue;
    const Eigen::Vector2d pixel = camera.Project(p_C);
    const bool inside =
        pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < camera.width && pixel.y() < camera.height;
    if (!inside) continue;
    candidate.whole += 1 / static_cast<double>(points.size());
    const int v = static_cast<int>(pixel.y()) / frame->depth_step;
    const int u = static_cast<int>(pixel.x()) / frame->depth_step;
    if (!FitsMeasured(frame->depth_mm, v, u, p_C.z())) continue;
    candidate.pixels += camera.fx * camera.fy / (p_C.z() * p_C.z());
  }
  return candidate;
}

// The best frames, of which none shows nearly the same as a better one as long as there are others.
std::vector<ViewCandidate> Choose(std::vector<ViewCandidate> candidates) {
  std::erase_if(candidates, [](const ViewCandidate& candidate) { return candidate.pixels <= 0; });
  std::vector<ViewCandidate> chosen;
  while (!candidates.empty() && chosen.size() < kCandidates) {
    const auto best = std::max_element(
        candidates.begin(), candidates.end(),
        [](const ViewCandidate& a, const ViewCandidate& b) { return a.value() < b.value(); });
    chosen.push_back(*best);
    candidates.erase(best);
    for (ViewCandidate& other : candidates) {
      const double distance = ViewDistance(other.frame->header, chosen.back().frame->header);
      other.novelty = std::min(other.novelty, distance / kEnoughDistance);
    }
  }
  return chosen;
}

// Finds the detection that covers nearly the same pixels as the mask.
void MatchDetection(const EvidenceFrame& frame, FrameMask* mask) {
  const auto segments =
      DecodeSegmentImage(frame.labels, frame.header.camera.width, frame.header.camera.height);
  if (!segments) return;  // the picture has no outline of a detection, then
  struct Counts {
    int both = 0, all = 0;
    EvidenceFrame::Segment segment;
  };
  std::map<int32_t, Counts> counts;  // by detection
  for (int v = 0; v < mask->mask.visible.height(); ++v) {
    for (int u = 0; u < mask->mask.visible.width(); ++u) {
      const auto index = static_cast<size_t>(segments->index(v * mask->step, u * mask->step));
      if (index >= frame.segments.size() || frame.segments[index].detection < 0) continue;
      Counts& count = counts[frame.segments[index].detection];
      count.segment = frame.segments[index];
      ++count.all;
      count.both += mask->mask.visible(v, u);
    }
  }
  for (const auto& [detection, count] : counts) {
    const double overlap =
        static_cast<double>(count.both) / (count.all + mask->mask.pixels - count.both);
    if (overlap < kLeastOverlap || overlap <= mask->overlap) continue;
    mask->detection = detection;
    mask->overlap = overlap;
    mask->class_id = count.segment.class_id;
    mask->score = count.segment.score;
  }
}

std::shared_ptr<const FrameMask> MakeMask(const EvidenceQuestion& question,
                                          const EvidenceFrame& frame) {
  const PinholeCamera& camera = frame.header.camera;
  auto made = std::make_shared<FrameMask>();
  made->step = (camera.width + EvidenceFinder::kMaskColumns - 1) / EvidenceFinder::kMaskColumns;
  made->mask = DrawObjectMask(*question.blocks, question.object, SmallerCamera(camera, made->step),
                              frame.header.T_W_C);
  KeepMeasured(frame.depth_mm, frame.depth_step, made->step, &made->mask);
  made->mask.closeness = {};
  MatchDetection(frame, made.get());
  return made;
}

}  // namespace

std::shared_ptr<const FrameMask> EvidenceFinder::MaskOf(const EvidenceQuestion& question,
                                                        const EvidenceFramePtr& frame) {
  const double now = MonotonicSeconds();
  for (const Known& known : known_) {
    const bool fresh = known.revision == question.revision || now - known.time < mask_kept_;
    if (known.frame == frame && known.object == question.object &&
        known.map_id == question.map_id && fresh)
      return known.mask;
  }
  auto mask = MakeMask(question, *frame);
  known_.push_back({frame, question.map_id, question.revision, question.object, now, mask});
  if (known_.size() > kMostMasks) known_.pop_front();
  return mask;
}

std::optional<std::vector<EvidenceView>> EvidenceFinder::Find(const EvidenceQuestion& question) {
  const auto points = SampleObject(*question.blocks, question.object, kSamples);
  if (points.empty()) return std::nullopt;
  std::vector<ViewCandidate> candidates;
  for (const EvidenceFramePtr& frame : store_.frames())
    candidates.push_back(Estimate(frame, points));
  const double end = MonotonicSeconds() + kMostTime;
  std::vector<EvidenceView> views;
  for (const ViewCandidate& candidate : Choose(std::move(candidates))) {
    if (MonotonicSeconds() > end) break;
    const auto mask = MaskOf(question, candidate.frame);
    if (mask->mask.pixels < kLeastPixels || mask->share() < kLeastShare) continue;
    views.push_back({candidate.frame, mask, int64_t{mask->mask.pixels} * mask->step * mask->step,
                     candidate.whole});
  }
  std::stable_sort(views.begin(), views.end(), [](const EvidenceView& a, const EvidenceView& b) {
    return static_cast<double>(a.pixels) * a.whole > static_cast<double>(b.pixels) * b.whole;
  });
  if (views.size() > kMostViews) views.resize(kMostViews);
  return views;
}

Result<Image<uint8_t>> DetectionMask(const EvidenceFrame& frame, int detection) {
  const PinholeCamera& camera = frame.header.camera;
  const auto segments = DecodeSegmentImage(frame.labels, camera.width, camera.height);
  if (!segments) return tl::unexpected(segments.error());
  Image<uint8_t> mask(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto index = static_cast<size_t>(segments->index(v, u));
      if (index < frame.segments.size() && frame.segments[index].detection == detection)
        mask(v, u) = 1;
    }
  }
  return mask;
}

}  // namespace vismap
