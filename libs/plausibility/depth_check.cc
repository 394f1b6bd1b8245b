#include "plausibility/depth_check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>

#include "base/format.h"

namespace vismap {
namespace {

constexpr int kStride = 4;
// The bits of a float are about its logarithm: bins with 5 bits of the mantissa are 3 % wide.
constexpr int kBinShift = 18;
constexpr uint32_t kFirstBin = std::bit_cast<uint32_t>(1e-4F) >> kBinShift;

size_t BinOf(float depth, int bins) {
  const uint32_t bin = std::bit_cast<uint32_t>(std::max(depth, 1e-4F)) >> kBinShift;
  return std::min(bin - kFirstBin, static_cast<uint32_t>(bins - 1));
}

double MiddleOfBin(int bin) {
  constexpr uint32_t kHalf = uint32_t{1} << (kBinShift - 1);
  return static_cast<double>(
      std::bit_cast<float>(((kFirstBin + static_cast<uint32_t>(bin)) << kBinShift) + kHalf));
}

double Share(int64_t part, int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

std::string Meters(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g m", value);
  return text.data();
}

bool LacksANeighbour(const Image<float>& depth, int v, int u) {
  for (const auto& [dv, du] : {std::pair{0, 1}, {1, 0}, {0, -1}, {-1, 0}}) {
    if (depth.Contains(v + dv, u + du) && !std::isfinite(depth(v + dv, u + du))) return true;
  }
  return false;
}

std::string HoleCause(double share_beside_holes) {
  return "the likely cause: " + FormatPercent(share_beside_holes) +
         " of the pixels with depth lie beside a hole that could not be filled, since it is too "
         "wide or its sides differ by more than the noise of the sensor (see `surface { "
         "max_hole_px }` in the config)";
}

}  // namespace

void DepthCheck::Add(const Image<float>& depth, const SegmentImage* segments) {
  ++frames_;
  // The offset changes with the frame, so that regular patterns of holes are counted fairly.
  const int offset = static_cast<int>(frames_ % kStride);
  for (int v = offset; v < depth.height(); v += kStride) {
    for (int u = (v / kStride + offset) % kStride; u < depth.width(); u += kStride) {
      ++pixels_;
      const double z = depth(v, u);
      if (!std::isfinite(z)) continue;
      ++with_depth_;
      ++histogram_[BinOf(depth(v, u), kBins)];
      if (z < limits_.nearest || z > limits_.farthest) continue;
      ++in_limits_;
      if (segments == nullptr) continue;
      ++segmented_;
      if (segments->index(v, u) != SegmentIndex::kNone) ++in_segments_;
      if (LacksANeighbour(depth, v, u)) ++isolated_;
    }
  }
}

double DepthCheck::share_with_depth() const { return Share(with_depth_, pixels_); }
double DepthCheck::share_in_limits() const { return Share(in_limits_, with_depth_); }
double DepthCheck::share_in_segments() const { return Share(in_segments_, segmented_); }

double DepthCheck::median() const {
  int64_t below = 0;
  for (int i = 0; i < kBins; ++i) {
    below += histogram_[static_cast<size_t>(i)];
    if (with_depth_ > 0 && 2 * below >= with_depth_) return MiddleOfBin(i);
  }
  return 0;
}

std::optional<std::string> DepthCheck::RangeFinding(double depth_unit_m) const {
  constexpr double kLeastDepth = 0.02, kLeastInLimits = 0.1;
  if (frames_ == 0) return std::nullopt;
  if (share_with_depth() < kLeastDepth) {
    return "only " + FormatPercent(share_with_depth()) +
           " of the pixels have a depth; is the depth image the right one?";
  }
  if (share_in_limits() >= kLeastInLimits) return std::nullopt;
  return "only " + FormatPercent(share_in_limits()) + " of the depths lie between " +
         Meters(limits_.nearest) + " and " + Meters(limits_.farthest) +
         ", where a map is made of them; their median is " + Meters(median()) +
         " with the unit that was taken, " + Meters(depth_unit_m) +
         " per step; is the unit right (--depth-unit)?";
}

std::optional<std::string> DepthCheck::SegmentFinding() const {
  constexpr double kLeastInSegments = 1.0 / 3, kManyHoles = 0.3;
  if (segmented_ == 0 || share_in_segments() >= kLeastInSegments) return std::nullopt;
  const double holes = Share(isolated_, segmented_);
  return "only " + FormatPercent(share_in_segments()) +
         " of the pixels with depth lie in segments, so few objects can be found; " +
         (holes > kManyHoles ? HoleCause(holes)
                             : "the likely cause: the depth is noisier than the sensor model says "
                               "(see `surface { sensor }` in the config), or its unit is wrong");
}

}  // namespace vismap
