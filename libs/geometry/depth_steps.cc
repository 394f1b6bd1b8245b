#include "geometry/depth_steps.h"

#include <algorithm>
#include <cmath>
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

}  // namespace

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
  const auto rank = static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(bends.size()));
  std::nth_element(bends.begin(), bends.begin() + rank, bends.end());
  const double needed = kMargin * double{bends[static_cast<size_t>(rank)]};
  return std::clamp(needed, jump_sigmas, kMostTimes * jump_sigmas);
}

}  // namespace vismap
