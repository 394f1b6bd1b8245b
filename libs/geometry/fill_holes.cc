#include "geometry/fill_holes.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"
#include "geometry/depth_steps.h"
#include "geometry/hole_kernels.h"

namespace vismap {
namespace {

constexpr size_t kRowGrain = 8;

/// An image with a margin of zeros of kHoleReach pixels on all sides, so that the kernels need not
/// know where it ends, and with rows of whole strips.
class PaddedImage {
 public:
  PaddedImage(int width, int height)
      : padded_width_((width + kHoleStrip - 1) / kHoleStrip * kHoleStrip),
        image_(padded_width_ + 2 * kHoleReach, height + 2 * kHoleReach) {}

  float* row(int v) { return image_.row(v + kHoleReach) + kHoleReach; }
  HoleRow ForKernel(int v) const {
    return {.w = image_.row(v + kHoleReach) + kHoleReach,
            .stride = image_.width(),
            .padded_width = padded_width_};
  }
  size_t padded_width() const { return static_cast<size_t>(padded_width_); }

 private:
  int padded_width_;
  Image<float> image_;
};

HoleConstants MakeConstants(const HoleOptions& options, double sigmas) {
  const DepthNoiseModel& noise = options.noise;
  const auto f = [](double x) { return static_cast<float>(x); };
  return {.max_length = f(std::min(options.max_px, kMaxHolePx) + 1),
          .sigmas_squared = f(sigmas * sigmas),
          .axial_base = f(noise.axial_base_m),
          .axial_quadratic = f(noise.axial_quadratic_per_m),
          .axial_offset = f(noise.axial_offset_m),
          .disparity_variance = f(noise.disparity_step_per_m * noise.disparity_step_per_m / 12)};
}

template <typename Body>
void ForRows(int height, const Body& body) {
  ParallelFor(static_cast<size_t>(height), kRowGrain,
              [&](size_t row) { body(static_cast<int>(row)); });
}

}  // namespace

HoleOptions HoleOptionsOf(const SurfaceOptions& options) {
  return {
      .max_px = options.max_hole_px, .sigmas = 0.6 * options.jump_sigmas, .noise = options.noise};
}

double HoleSigmas(const Image<float>& depth, const HoleOptions& options) {
  return std::clamp(1.5 * BendAcrossHoles(depth, options.noise), options.sigmas,
                    2.5 * options.sigmas);
}

void FillHoles(const HoleOptions& options, Image<float>* depth) {
  if (options.max_px <= 0 || depth->empty()) return;
  const HoleConstants constants = MakeConstants(options, HoleSigmas(*depth, options));
  const int width = depth->width(), height = depth->height();
  PaddedImage measured(width, height), filled(width, height);
  ForRows(height, [&](int v) { InvertDepth(depth->row(v), width, measured.row(v)); });
  ForRows(height, [&](int v) { FillRow(measured.ForKernel(v), constants, filled.row(v)); });
  ForRows(height, [&](int v) {
    std::vector<float> row(filled.padded_width());
    FillRow(filled.ForKernel(v), constants, row.data());
    AddFilledDepth(row.data(), width, depth->row(v));
  });
}

}  // namespace vismap
