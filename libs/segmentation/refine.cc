#include "segmentation/refine.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "base/require.h"
#include "segmentation/mask_sets.h"
#include "segmentation/runs.h"

namespace vismap {
namespace {

constexpr int32_t kNobody = -1;

size_t At(SegmentIndex index) { return static_cast<size_t>(Raw(index)); }
size_t At(int32_t index) { return static_cast<size_t>(index); }

/// The runs of pixels of one segment.
RunTable SegmentRuns(const Image<SegmentIndex>& index) {
  return {index.width(), index.height(),
          [&index](int v, RunFlags flags) { MarkSegments(index.row(v), index.width(), flags); }};
}

/// Calls visit(v, u) for the pixels of a mask that lie in the image, in row order.
template <typename Visit>
void ForMask(const Mask& mask, int width, int height, const Visit& visit) {
  for (int y = std::max(0, -mask.v0); y < std::min(mask.inside.height(), height - mask.v0); ++y) {
    const uint8_t* inside = mask.inside.row(y);
    for (int x = std::max(0, -mask.u0); x < std::min(mask.inside.width(), width - mask.u0); ++x) {
      if (inside[x]) visit(y + mask.v0, x + mask.u0);
    }
  }
}

/// The detections that take part, best first: by score, then smaller area, then index.
std::vector<int32_t> RankDetections(const DetectionSet& set, double min_score) {
  std::vector<int32_t> order;
  std::vector<int32_t> area;
  for (size_t k = 0; k < set.detections.size(); ++k) {
    area.push_back(MaskArea(set.detections[k].mask));
    if (set.detections[k].score >= min_score) order.push_back(static_cast<int32_t>(k));
  }
  std::stable_sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
    const float score_a = set.detections[At(a)].score, score_b = set.detections[At(b)].score;
    return score_a != score_b ? score_a > score_b : area[At(a)] < area[At(b)];
  });
  return order;
}

bool OfOneThing(const Detection& a, const Detection& b, double same_part) {
  constexpr int kTimes = 3;  // what is smaller may be a thing on or beside one of its kind
  if (a.class_id != b.class_id || same_part >= 1) return false;
  const int32_t area_a = MaskArea(a.mask), area_b = MaskArea(b.mask);
  const int32_t small = std::min(area_a, area_b);
  return kTimes * small >= std::max(area_a, area_b) &&
         SharedArea(a.mask, b.mask) > same_part * small;
}

/// The masks of a frame against its segments.
class Refiner {
 public:
  Refiner(const DetectionSet& set, const RefineOptions& options, SegmentedFrame* out)
      : set_(set),
        options_(options),
        out_(*out),
        width_(out->image.index.width()),
        height_(out->image.index.height()),
        order_(RankDetections(set, options.min_score)) {
    if (!options_.resolve_overlaps) return;
    PutTogether();
    ClaimPixels();
  }

  /// Before what follows: looks at what is inside the masks.
  void Count();
  void Split();
  void Match();
  /// `depths` = mean depth per segment [m].
  void DropSeenThrough(const std::vector<double>& depths);
  /// Gives loose pieces to the object whose mask covers them. `depths` as before.
  void TakeLoose(const std::vector<double>& depths);
  /// Gives pixels on folds to the object in whose mask they lie.
  void TakeFolds();

 private:
  /// Pixels per segment that belong to mask k.
  std::vector<int32_t> CountInside(int32_t k) const;
  const Mask& MaskOf(int32_t k) const {
    const auto joint = joint_.find(k);
    return joint != joint_.end() ? joint->second : set_.detections[At(k)].mask;
  }
  void PutTogether();
  void ClaimPixels();
  bool Splits(int32_t inside, int32_t pixels, int32_t mask_pixels) const;
  int32_t Scaled(int pixels_at_vga) const;
  std::vector<size_t> MainSegments() const;
  /// Whether a depth [m] is within `extent` larger sides of the detection's mask of another.
  bool IsNear(double depth, double main_depth, size_t detection, double extent) const;
  struct LoosePiece;
  std::vector<LoosePiece> LoosePieces() const;
  void Give(const LoosePiece& piece, SegmentIndex to);
  bool OnOneSurface(int v, int u, int y, int x) const;
  void TakeFoldsOf(int32_t k);

  template <typename Visit>
  void ForPixelsOf(int32_t k, const Visit& visit) const {
    ForMask(MaskOf(k), width_, height_, [&](int v, int u) {
      if (owner_.empty() || owner_(v, u) == k) visit(v, u);
    });
  }

  template <typename Visit>
  void ForMasksAt(int v, int u, const Visit& visit) const {
    if (!owner_.empty()) {
      if (owner_(v, u) != kNobody) visit(owner_(v, u));
      return;
    }
    for (const int32_t k : order_) {
      if (set_.detections[At(k)].mask.Contains(v, u)) visit(k);
    }
  }

  const DetectionSet& set_;
  const RefineOptions& options_;
  SegmentedFrame& out_;
  int width_, height_;
  std::vector<int32_t> order_;
  std::map<int32_t, Mask> joint_;  ///< of detections with others of the same thing
  Image<int32_t> owner_;  ///< detection that owns the pixel; empty = masks may share pixels
  std::vector<std::vector<int32_t>> inside_;  ///< CountInside of each in order_
};

// The weaker of two detections of one thing leaves the ranking.
void Refiner::PutTogether() {
  std::vector<int32_t> leaders;
  for (const int32_t k : order_) {
    const Detection& detection = set_.detections[At(k)];
    const auto leader = std::find_if(leaders.begin(), leaders.end(), [&](int32_t better) {
      return OfOneThing(set_.detections[At(better)], detection, options_.same_part);
    });
    if (leader == leaders.end()) {
      leaders.push_back(k);
    } else {
      joint_[*leader] = UnionOf(MaskOf(*leader), detection.mask);
    }
  }
  order_ = std::move(leaders);
}

void Refiner::ClaimPixels() {
  owner_ = Image<int32_t>(width_, height_, kNobody);
  // Undermost, so that a second mask that is too large takes nothing from another thing.
  for (const auto& [k, mask] : joint_)
    ForMask(mask, width_, height_, [&](int v, int u) { owner_(v, u) = k; });
  for (auto k = order_.rbegin(); k != order_.rend(); ++k) {  // the best one last, on top
    ForMask(set_.detections[At(*k)].mask, width_, height_,
            [&](int v, int u) { owner_(v, u) = *k; });
  }
}

std::vector<int32_t> Refiner::CountInside(int32_t k) const {
  std::vector<int32_t> inside(out_.segments.size());
  ForPixelsOf(k, [&](int v, int u) {
    const SegmentIndex segment = out_.image.index(v, u);
    if (segment != SegmentIndex::kNone) ++inside[At(segment)];
  });
  return inside;
}

int32_t Refiner::Scaled(int pixels_at_vga) const {
  const double area = static_cast<double>(width_) * height_ / (640.0 * 480.0);
  return std::max(1, static_cast<int32_t>(std::lround(pixels_at_vga * area)));
}

bool Refiner::Splits(int32_t inside, int32_t pixels, int32_t mask_pixels) const {
  return inside >= Scaled(options_.split_min_px) &&
         pixels - inside >= Scaled(options_.split_min_rest_px) &&
         inside >= options_.split_min_mask_part * mask_pixels &&
         inside <= options_.min_overlap * pixels;  // otherwise the mask gets the whole segment
}

void Refiner::Count() {
  inside_.resize(order_.size());
  ParallelFor(order_.size(), 1, [&](size_t rank) { inside_[rank] = CountInside(order_[rank]); });
}

void Refiner::Split() {
  for (size_t rank = 0; rank < order_.size(); ++rank) {
    const int32_t k = order_[rank];
    if (set_.detections[At(k)].score < options_.split_min_score) continue;
    std::vector<int32_t>& inside = inside_[rank];
    const int32_t mask_pixels = std::accumulate(inside.begin(), inside.end(), 0);
    const size_t main =
        static_cast<size_t>(std::max_element(inside.begin(), inside.end()) - inside.begin());
    if (inside.empty() || !Splits(inside[main], out_.segments[main].pixels, mask_pixels)) continue;
    const auto cut = static_cast<SegmentIndex>(out_.image.segment_count++);
    ForPixelsOf(k, [&](int v, int u) {
      SegmentIndex& segment = out_.image.index(v, u);
      if (segment != SegmentIndex::kNone && At(segment) == main) segment = cut;
    });
    out_.segments[main].pixels -= inside[main];
    out_.segments.push_back({.pixels = inside[main]});
    inside.resize(out_.segments.size());
    inside.back() = std::exchange(inside[main], 0);
    if (owner_.empty()) Count();  // others had these pixels, too
  }
}

void Refiner::Match() {
  for (size_t rank = 0; rank < order_.size(); ++rank) {  // a later one must cover strictly more
    const int32_t k = order_[rank];
    const Detection& detection = set_.detections[At(k)];
    const std::vector<int32_t>& inside = inside_[rank];
    for (size_t i = 0; i < inside.size(); ++i) {
      FrameSegment& segment = out_.segments[i];
      const float overlap = static_cast<float>(inside[i]) / static_cast<float>(segment.pixels);
      if (!(overlap > static_cast<float>(options_.min_overlap)) || overlap <= segment.overlap) {
        continue;
      }
      segment.detection = static_cast<DetectionIndex>(k);
      segment.class_id = detection.class_id;
      segment.score = detection.score;
      segment.overlap = overlap;
    }
  }
}

/// Mean depth per segment [m].
std::vector<double> MeanDepths(const SegmentedFrame& out) {
  const RunTable table = SegmentRuns(out.image.index);
  const std::vector<Run>& runs = table.runs();
  std::vector<double> sums(runs.size());
  ParallelFor(runs.size(), 256, [&](size_t i) {
    const float* depth = out.frame.depth.row(runs[i].v);
    sums[i] = std::accumulate(depth + runs[i].begin, depth + runs[i].end, 0.0);
  });
  std::vector<double> depths(out.segments.size());
  for (size_t i = 0; i < runs.size(); ++i)
    depths[At(out.image.index(runs[i].v, runs[i].begin))] += sums[i];
  for (size_t i = 0; i < depths.size(); ++i) depths[i] /= out.segments[i].pixels;
  return depths;
}

/// The largest segment of every detection; out of range = it has none.
std::vector<size_t> Refiner::MainSegments() const {
  std::vector<size_t> main(set_.detections.size(), out_.segments.size());
  for (size_t i = 0; i < out_.segments.size(); ++i) {
    if (out_.segments[i].detection == DetectionIndex::kNone) continue;
    size_t& best = main[At(Raw(out_.segments[i].detection))];
    if (best == out_.segments.size() || out_.segments[i].pixels > out_.segments[best].pixels)
      best = i;
  }
  return main;
}

bool Refiner::IsNear(double depth, double main_depth, size_t detection, double extent) const {
  if (extent <= 0) return true;
  const PinholeCamera& camera = out_.frame.header.camera;
  const Image<uint8_t>& box = MaskOf(static_cast<int32_t>(detection)).inside;
  const double side = main_depth * std::max(box.width() / camera.fx, box.height() / camera.fy);
  return std::abs(depth - main_depth) <= extent * side;
}

void Refiner::DropSeenThrough(const std::vector<double>& depths) {
  const std::vector<size_t> main = MainSegments();
  for (size_t i = 0; i < out_.segments.size(); ++i) {
    FrameSegment& segment = out_.segments[i];
    if (segment.detection == DetectionIndex::kNone) continue;
    const auto k = At(Raw(segment.detection));
    if (!IsNear(depths[i], depths[main[k]], k, options_.max_depth_extent))
      segment = {.pixels = segment.pixels};
  }
}

/// A loose piece that no detection has yet.
struct Refiner::LoosePiece {
  std::vector<LooseRun> runs;
  int32_t pixels = 0;
  double depth = 0;             ///< summed [m]
  std::vector<int32_t> inside;  ///< pixels per detection
};

std::vector<Refiner::LoosePiece> Refiner::LoosePieces() const {
  std::vector<LoosePiece> pieces;
  for (const LooseRun& run : out_.image.loose) {
    const SegmentIndex segment = out_.image.index(run.v, run.begin);
    if (segment != SegmentIndex::kNone &&
        out_.segments[At(segment)].detection != DetectionIndex::kNone)
      continue;
    if (At(run.piece) >= pieces.size()) pieces.resize(At(run.piece) + 1);
    LoosePiece& piece = pieces[At(run.piece)];
    piece.runs.push_back(run);
    piece.pixels += run.end - run.begin;
    piece.inside.resize(set_.detections.size());
    for (int u = run.begin; u < run.end; ++u) {
      piece.depth += out_.frame.depth(run.v, u);
      ForMasksAt(run.v, u, [&](int32_t k) { ++piece.inside[At(k)]; });
    }
  }
  std::erase_if(pieces, [](const LoosePiece& piece) { return piece.pixels == 0; });
  return pieces;
}

void Refiner::Give(const LoosePiece& piece, SegmentIndex to) {
  for (const LooseRun& run : piece.runs) {
    for (int u = run.begin; u < run.end; ++u) {
      SegmentIndex& segment = out_.image.index(run.v, u);
      if (segment != SegmentIndex::kNone) --out_.segments[At(segment)].pixels;
      segment = to;
    }
  }
  out_.segments[At(to)].pixels += piece.pixels;
}

void Refiner::TakeLoose(const std::vector<double>& depths) {
  const std::vector<size_t> main = MainSegments();
  for (const LoosePiece& piece : LoosePieces()) {
    for (const int32_t k : order_) {
      const size_t to = main[At(k)];
      if (to == out_.segments.size()) continue;
      if (piece.inside[At(k)] <= options_.min_overlap * piece.pixels) continue;
      if (!IsNear(piece.depth / piece.pixels, depths[to], At(k), options_.loose_depth_extent))
        continue;
      Give(piece, static_cast<SegmentIndex>(to));
      break;
    }
  }
}

bool Refiner::OnOneSurface(int v, int u, int y, int x) const {
  constexpr float kStep = 0.02F;  // of the depth, from pixel to pixel: a fold has none, a jump more
  const float a = out_.frame.depth(v, u), b = out_.frame.depth(y, x);
  return std::abs(a - b) <= kStep * std::min(a, b);
}

void Refiner::TakeFoldsOf(int32_t k) {
  const auto mine = [&](SegmentIndex segment) {
    return segment != SegmentIndex::kNone && Raw(out_.segments[At(segment)].detection) == k;
  };
  std::vector<std::pair<int, int>> open;  // pixels of the object, from which it grows
  ForPixelsOf(k, [&](int v, int u) {
    if (mine(out_.image.index(v, u)) && out_.image.ambiguous(v, u) > 1) open.emplace_back(v, u);
  });
  const Mask& mask = MaskOf(k);
  for (size_t next = 0; next < open.size(); ++next) {  // `open` grows
    const auto [v, u] = open[next];
    for (const auto& [dv, du] : {std::pair{0, 1}, {1, 0}, {0, -1}, {-1, 0}}) {
      const int y = v + dv, x = u + du;
      if (!out_.image.index.Contains(y, x) || out_.image.ambiguous(y, x) <= 1) continue;
      if (!mask.Contains(y, x) || (!owner_.empty() && owner_(y, x) != k)) continue;
      SegmentIndex& segment = out_.image.index(y, x);
      if (segment == SegmentIndex::kNone || mine(segment) || !OnOneSurface(v, u, y, x)) continue;
      FrameSegment& loser = out_.segments[At(segment)];
      if (loser.detection != DetectionIndex::kNone || loser.pixels <= 1) continue;
      --loser.pixels;
      segment = out_.image.index(v, u);
      ++out_.segments[At(segment)].pixels;
      open.emplace_back(y, x);
    }
  }
}

void Refiner::TakeFolds() {
  for (const int32_t k : order_) {
    if (set_.detections[At(k)].score >= options_.fold_min_score) TakeFoldsOf(k);
  }
}

}  // namespace

SegmentedFrame RefineWithDetections(RgbdFrame frame, SegmentImage image,
                                    const DetectionSet* detections, const RefineOptions& options) {
  Require(
      frame.depth.width() == image.index.width() && frame.depth.height() == image.index.height(),
      "a segment image has the size of its frame");
  SegmentedFrame out{std::move(frame), std::move(image), {}, detections != nullptr};
  out.segments.resize(At(out.image.segment_count));
  const RunTable table = SegmentRuns(out.image.index);
  for (const Run& run : table.runs())
    out.segments[At(out.image.index(run.v, run.begin))].pixels += run.length();
  if (detections == nullptr) {
    out.image.ambiguous = {};
    out.image.loose = {};
    return out;
  }
  Refiner refiner(*detections, options, &out);
  refiner.Count();
  if (options.split) refiner.Split();
  refiner.Match();
  if (!detections->detections.empty()) {
    const std::vector<double> depths = MeanDepths(out);
    refiner.DropSeenThrough(depths);
    if (options.take_loose) refiner.TakeLoose(depths);
  }
  if (options.fold_min_score <= 1 && !out.image.ambiguous.empty()) refiner.TakeFolds();
  out.image.ambiguous = {};
  out.image.loose = {};
  return out;
}

}  // namespace vismap
