#include "plausibility/depth_losses.h"

#include <array>
#include <cstdio>

#include "base/format.h"

namespace vismap {
namespace {

constexpr double kManyLost = 0.05;  // of the pixels

std::string InMetres(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g m", value);
  return text.data();
}

}  // namespace

std::vector<std::string> FindingsOf(const DepthLosses& losses, const SurfaceOptions& options) {
  std::vector<std::string> findings;
  const auto tell = [&](int64_t lost, const std::string& what) {
    const double share =
        losses.pixels > 0 ? static_cast<double>(lost) / static_cast<double>(losses.pixels) : 0;
    if (share > kManyLost) findings.push_back(FormatPercent(share) + " of the pixels " + what);
  };
  tell(losses.saturated,
       "have exactly the same depth, " + InMetres(losses.saturated_m) +
           ", where nothing can be, and count as no return; the likely cause: the camera gives "
           "this value for glass and beyond its range (`surface { drop_saturated: false }` in the "
           "config keeps them)");
  tell(losses.too_far, "are farther than " + InMetres(options.max_depth_m) +
                           " and count as no return; the likely cause: the camera gives a large "
                           "value where it measured nothing, the unit of the depth is wrong, or "
                           "the place is larger than that (`surface { max_depth_m }` in the "
                           "config)");
  tell(losses.too_near, "are nearer than " + InMetres(options.min_depth_m) +
                            " and count as no return; the likely cause: the unit of the depth is "
                            "wrong, or something is before the camera (`surface { min_depth_m }` "
                            "in the config)");
  return findings;
}

}  // namespace vismap
