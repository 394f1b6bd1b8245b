#include "geometry/depth_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace vismap {
namespace {

constexpr int kRowStep = 4, kColumnStep = 3;  // of the samples [px]
constexpr size_t kMinSamples = 500;
// Measured bends at this quantile: 1.4 to 2.2 standard deviations for Kinects (7-Scenes, TUM,
// Redwood) and the simulated one, so that their limit stays at 5; 5.4 for a sensor with depth steps
// three times as coarse.
constexpr double kQuantile = 0.9, kMargin = 1.3, kMostTimes = 2.5;

/// The bend between the inner two of four neighbours in standard deviations: the smaller of the
/// second differences to either side. Negative when one of them has no depth.
float Bend(const float* w, const float* sigma) {
  if (!(w[0] > 0 && w[1] > 0 && w[2] > 0 && w[3] > 0)) return -1;
  const float step = w[2] - w[1];
  const float bend = std::min(std::abs(step - (w[1] - w[0])), std::abs(step - (w[3] - w[2])));
  return bend / std::max(sigma[1], sigma[2]);
}

/// The value that a tenth of the bends exceed.
double Quantile(std::vector<float>* bends) {
  const auto rank = static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(bends->size()));
  std::nth_element(bends->begin(), bends->begin() + rank, bends->end());
  return (*bends)[static_cast<size_t>(rank)];
}

/// Four pixels with depth in a row.
struct SparseSample {
  std::array<double, 4> w{};
  std::array<int, 4> u{};
};

std::optional<SparseSample> FindSample(const float* depth, int begin, int end) {
  constexpr int kNearest = 2, kFarthest = 5;
  SparseSample sample;
  size_t found = 0;
  for (int u = begin; u < end && found < 4;) {
    if (found > 0 && u - sample.u[found - 1] > kFarthest) return std::nullopt;
    if (!(depth[u] > 0 && std::isfinite(depth[u]))) {
      ++u;
      continue;
    }
    sample.w[found] = 1 / double{depth[u]};
    sample.u[found++] = u;
    u += kNearest;
  }
  return found == 4 ? std::optional(sample) : std::nullopt;
}

/// In standard deviations. The noise of a difference of slopes over the distances d and e is that
/// of neighbours, sqrt(6), times sqrt((1/d^2 + (1/d + 1/e)^2 + 1/e^2) / 6).
double BendOf(const SparseSample& sample, const DepthNoiseModel& noise) {
  std::array<double, 3> slope{}, inverse{};
  for (size_t i = 0; i < 3; ++i) {
    inverse[i] = 1.0 / (sample.u[i + 1] - sample.u[i]);
    slope[i] = (sample.w[i + 1] - sample.w[i]) * inverse[i];
  }
  const auto second_difference = [&](size_t i) {
    const double d = inverse[i], e = inverse[i + 1];
    return std::abs(slope[i + 1] - slope[i]) / std::sqrt((d * d + (d + e) * (d + e) + e * e) / 6);
  };
  const double w = sample.w[1], axial = noise.AxialSigma(1 / w) * w * w;
  const double step = noise.disparity_step_per_m;
  return std::min(second_difference(0), second_difference(1)) /
         std::sqrt(axial * axial + step * step / 12);
}

}  // namespace

double BendAcrossHoles(const Image<float>& depth, const DepthNoiseModel& noise) {
  constexpr int kRowDistance = 16, kColumnDistance = 17, kLength = 24;
  constexpr size_t kFewest = 100;
  std::vector<float> bends;
  for (int i = 0; i * kRowDistance < depth.height(); ++i) {
    const int v = i * kRowDistance + 5 * i % kRowDistance;
    if (v >= depth.height()) break;
    for (int u = 0; u < depth.width(); u += kColumnDistance) {
      const auto sample = FindSample(depth.row(v), u, std::min(depth.width(), u + kLength));
      if (sample) bends.push_back(static_cast<float>(BendOf(*sample, noise)));
    }
  }
  return bends.size() < kFewest ? 0 : Quantile(&bends);
}

double JumpSigmas(const Image<float>& w, const Image<float>& sigma, double jump_sigmas) {
  std::vector<float> bends;
  bends.reserve(w.size() / (kRowStep * kColumnStep) + static_cast<size_t>(w.height()));
  for (int v = 0; v < w.height(); v += kRowStep) {
    for (int u = 0; u + 3 < w.width(); u += kColumnStep) {
      const float bend = Bend(w.row(v) + u, sigma.row(v) + u);
      if (bend >= 0) bends.push_back(bend);
    }
  }
  if (bends.size() < kMinSamples) return jump_sigmas;
  const double needed = kMargin * Quantile(&bends);
  return std::clamp(needed, jump_sigmas, kMostTimes * jump_sigmas);
}

}  // namespace vismap
