#include "geometry/saturated_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

namespace vismap {
namespace {

// Values from here on are judged even when only a few pixels have them [m].
constexpr double kFar = 5.0;
constexpr int64_t kFewestFar = 4;          // pixels with one far value that can be judged
constexpr double kLeastNearShare = 0.005;  // of the image, for a value that is not far
constexpr double kMostContinued = 0.2;     // of the border of a saturated value
constexpr double kMostJustBefore = 0.02;   // pixels just before a saturated value that is not far
constexpr double kNoisyShare = 0.1;        // of the places where noise can be told
constexpr int64_t kFewestPlaces = 200;

/// The pixels that share one value.
struct Tally {
  int64_t pixels = 0;
  int64_t border = 0;     // pairs of such a pixel and a neighbour with another depth
  int64_t continued = 0;  // of these: depths that may be of one surface
  double tolerance = 0;   // [m]
};

template <typename T>
bool IsDepth(T value) {
  if constexpr (std::is_integral_v<T>) {
    return value != 0 && value != std::numeric_limits<T>::max();
  } else {
    return value > 0 && std::isfinite(value);
  }
}

/// Judges the values of the depth image of one frame, which is in steps of `unit` metres.
template <typename T>
class SaturationJudge {
 public:
  SaturationJudge(const SurfaceOptions& options, const Image<T>& depth, double unit)
      : noise_(options.noise), depth_(depth), unit_(unit) {}

  // The values up to `largest`, the largest within the limits, that are no measurement; ascending.
  std::vector<T> Saturated(T largest) {
    std::vector<T> found;
    const bool is_far = Metres(largest) > kFar;
    const T from = is_far ? FirstFar() : largest;
    const double least = kLeastNearShare * static_cast<double>(depth_.size());
    if (!is_far && static_cast<double>(Count(largest)) < least) return found;
    TallyBetween(from, largest);
    for (const auto& [value, tally] : tallies_) {
      if (is_far ? IsSaturatedFar(value, tally) : IsSaturatedNear(value, tally))
        found.push_back(value);
    }
    std::sort(found.begin(), found.end());
    return found;
  }
  int64_t PixelsOf(T value) const { return tallies_.at(value).pixels; }

 private:
  // The resolution of the image, or what noise-free depth may be rounded to [m].
  double Step() const { return std::is_integral_v<T> ? unit_ : 0.001; }
  double Metres(T value) const { return static_cast<double>(value) * unit_; }
  T FirstFar() const {
    const double first = kFar / unit_;
    if constexpr (std::is_integral_v<T>) {
      return static_cast<T>(std::min(std::floor(first) + 1, 65535.0));
    } else {
      return std::nextafter(static_cast<T>(first), std::numeric_limits<T>::infinity());
    }
  }
  int64_t Count(T value) const {
    return std::count(depth_.pixels().begin(), depth_.pixels().end(), value);
  }

  // How far apart two readings of one surface can be.
  double Tolerance(double z) const {
    return std::max(4 * noise_.AxialSigma(z), 2 * noise_.disparity_step_per_m * z * z) + 2 * Step();
  }

  void TallyBetween(T from, T to) {
    T last = 0;
    Tally* tally = nullptr;  // of `last`
    for (int v = 0; v < depth_.height(); ++v) {
      for (int u = 0; u < depth_.width(); ++u) {
        const T value = depth_(v, u);
        if (!(value >= from && value <= to)) continue;
        if (tally == nullptr || value != last) {
          tally = &tallies_[value];
          last = value;
          if (tally->pixels == 0) tally->tolerance = Tolerance(Metres(value));
        }
        ++tally->pixels;
        CountBorder(v, u, tally);
      }
    }
  }

  void CountBorder(int v, int u, Tally* tally) const {
    for (const auto& [dv, du] : {std::pair{0, 1}, {1, 0}, {0, -1}, {-1, 0}}) {
      if (!depth_.Contains(v + dv, u + du)) continue;
      const T other = depth_(v + dv, u + du);
      if (other == depth_(v, u) || !IsDepth(other)) continue;
      ++tally->border;
      if (std::abs(Metres(other) - Metres(depth_(v, u))) <= tally->tolerance) ++tally->continued;
    }
  }

  bool IsSaturatedFar(T value, const Tally& tally) {
    if (tally.pixels < kFewestFar || !EndsAtBorder(tally)) return false;
    const double metres = Metres(value), whole = std::round(metres);
    return std::abs(metres - whole) < (std::is_integral_v<T> ? 0.5 * unit_ : 1e-4) ||
           !IsFreeOfNoise();
  }

  bool IsSaturatedNear(T value, const Tally& tally) {
    if (tally.border == 0 || !EndsAtBorder(tally)) return false;
    const auto just_before = std::count_if(
        depth_.pixels().begin(), depth_.pixels().end(),
        [&](T other) { return other < value && Metres(value) - Metres(other) <= tally.tolerance; });
    return static_cast<double>(just_before) <=
               kMostJustBefore * static_cast<double>(tally.pixels) &&
           IsNoisy();
  }

  static bool EndsAtBorder(const Tally& tally) {
    return static_cast<double>(tally.continued) <=
           kMostContinued * static_cast<double>(tally.border);
  }

  bool IsNoisy() {
    MeasureNoise();
    return places_ >= kFewestPlaces && NoisyShare() >= kNoisyShare;
  }
  bool IsFreeOfNoise() {
    MeasureNoise();
    return places_ >= kFewestPlaces && NoisyShare() < kNoisyShare;
  }
  double NoisyShare() const { return static_cast<double>(noisy_) / static_cast<double>(places_); }

  // Counts where three nearer pixels side by side are no straight line in depth, but no edge
  // either. Of planes without noise the second difference is below two steps.
  void MeasureNoise() {
    constexpr int kStride = 4;
    if (places_ > 0) return;
    const double least = std::max(2.5 * Step(), 0.0025);
    for (int v = 0; v < depth_.height(); v += kStride) {
      const T* row = depth_.row(v);
      for (int u = 1; u + 1 < depth_.width(); ++u) {
        if (!IsDepth(row[u - 1]) || !IsDepth(row[u]) || !IsDepth(row[u + 1])) continue;
        const double z = Metres(row[u]);
        const double bend = std::abs(Metres(row[u - 1]) - 2 * z + Metres(row[u + 1]));
        if (z > kFar || bend > 2 * Tolerance(z)) continue;
        ++places_;
        noisy_ += bend > least ? 1 : 0;
      }
    }
  }

  const DepthNoiseModel& noise_;
  const Image<T>& depth_;
  double unit_;
  std::unordered_map<T, Tally> tallies_;  // its order reaches no output
  int64_t places_ = 0, noisy_ = 0;
};

/// The limits of depth in the steps of an image. A whole number of steps that equals a limit but
/// for rounding is within it.
template <typename T>
struct StepLimits {
  T nearest, farthest;

  StepLimits(const SurfaceOptions& options, double unit) {
    const double near = options.min_depth_m / unit * (1 - 1e-6);
    const double far = options.max_depth_m / unit * (1 + 1e-6);
    if constexpr (std::is_integral_v<T>) {
      nearest = static_cast<T>(std::min(std::ceil(near), 65535.0));
      farthest = static_cast<T>(std::min(std::floor(far), 65534.0));
    } else {
      nearest = static_cast<T>(near);
      farthest = static_cast<T>(far);
    }
  }
};

template <typename T>
DepthLosses DropFrom(const SurfaceOptions& options, double unit, T none, Image<T>* depth) {
  DepthLosses losses{.frames = 1, .pixels = static_cast<int64_t>(depth->size())};
  const StepLimits<T> limits(options, unit);
  T largest = 0;
  for (const T value : depth->pixels()) {
    const bool far = value > limits.farthest && IsDepth(value);
    losses.too_near += value < limits.nearest && IsDepth(value) ? 1 : 0;
    losses.too_far += far ? 1 : 0;
    if (value <= limits.farthest) largest = std::max(largest, value);
  }
  if (!options.drop_saturated || largest == 0) return losses;
  SaturationJudge<T> judge(options, *depth, unit);
  const std::vector<T> saturated = judge.Saturated(largest);
  if (saturated.empty()) return losses;
  int64_t most = 0;
  for (const T value : saturated) {
    const int64_t pixels = judge.PixelsOf(value);
    losses.saturated += pixels;
    if (pixels > most) losses.saturated_m = static_cast<double>(value) * unit;
    most = std::max(most, pixels);
  }
  for (T& value : depth->pixels()) {
    if (std::binary_search(saturated.begin(), saturated.end(), value)) value = none;
  }
  return losses;
}

}  // namespace

void DepthLosses::Add(const DepthLosses& other) {
  frames += other.frames;
  pixels += other.pixels;
  too_near += other.too_near;
  too_far += other.too_far;
  saturated += other.saturated;
  if (other.saturated > 0) saturated_m = other.saturated_m;
}

DepthLosses DropSaturatedDepth(const SurfaceOptions& options, SensorFrame* frame) {
  if (!frame->depth.empty())
    return DropFrom<uint16_t>(options, frame->depth_unit_m, 0, &frame->depth);
  return DropFrom<float>(options, 1, std::numeric_limits<float>::quiet_NaN(), &frame->depth_m);
}

}  // namespace vismap
