#include "detection/soft_mask.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/require.h"

namespace vismap {
namespace {

/// The two neighbouring cells of a pixel along one axis, and the weight of the second one.
struct Tap {
  int low = 0, high = 0;
  float part = 0;
};

/// The taps of the pixels [begin, end) along one axis.
std::vector<Tap> Taps(int begin, int end, double scale, double offset, int cells) {
  std::vector<Tap> taps;
  for (int i = begin; i < end; ++i) {
    const double at = std::clamp((i + 0.5) * scale + offset - 0.5, 0.0, cells - 1.0);
    const int low = static_cast<int>(at);
    taps.push_back({low, std::min(low + 1, cells - 1), static_cast<float>(at - low)});
  }
  return taps;
}

/// The first pixel whose centre is at or beyond an edge, limited to the image; NaN becomes 0.
int FirstPixel(float edge, int side) {
  const float first = std::ceil(edge - 0.5f);
  return first > 0 ? static_cast<int>(std::min(first, static_cast<float>(side))) : 0;
}

/// Computes one row of the mask by bilinear interpolation.
void FillRow(const SoftMask& soft, const Tap& row, const std::vector<Tap>& columns, float threshold,
             uint8_t* inside) {
  const float* low = &soft.values[static_cast<size_t>(row.low) * static_cast<size_t>(soft.width)];
  const float* high = &soft.values[static_cast<size_t>(row.high) * static_cast<size_t>(soft.width)];
  for (size_t i = 0; i < columns.size(); ++i) {
    const Tap& column = columns[i];
    const float a = low[column.low] + column.part * (low[column.high] - low[column.low]);
    const float b = high[column.low] + column.part * (high[column.high] - high[column.low]);
    inside[i] = a + row.part * (b - a) > threshold ? 1 : 0;
  }
}

/// The mask with the smallest box around its pixels.
Mask Tightened(const Mask& loose) {
  Box bounds{1e9f, 1e9f, -1, -1};
  const Image<uint8_t>& inside = loose.inside;
  for (int v = 0; v < inside.height(); ++v) {
    for (int u = 0; u < inside.width(); ++u) {
      if (inside(v, u) == 0) continue;
      const auto x = static_cast<float>(u), y = static_cast<float>(v);
      bounds = {std::min(bounds.u0, x), std::min(bounds.v0, y), std::max(bounds.u1, x),
                std::max(bounds.v1, y)};
    }
  }
  Mask mask{loose.image_width, loose.image_height, 0, 0, {}};
  if (bounds.u1 < 0) return mask;
  const int u0 = static_cast<int>(bounds.u0), v0 = static_cast<int>(bounds.v0);
  mask.u0 = loose.u0 + u0;
  mask.v0 = loose.v0 + v0;
  mask.inside =
      Image<uint8_t>(static_cast<int>(bounds.u1) - u0 + 1, static_cast<int>(bounds.v1) - v0 + 1);
  for (int v = 0; v < mask.inside.height(); ++v)
    std::copy_n(inside.row(v0 + v) + u0, mask.inside.width(), mask.inside.row(v));
  return mask;
}

}  // namespace

Mask MaskFromSoft(const SoftMask& soft, const Box& box, int image_width, int image_height,
                  float threshold) {
  Require(
      soft.width > 0 && soft.height > 0 &&
          soft.values.size() == static_cast<size_t>(soft.width) * static_cast<size_t>(soft.height),
      "a soft mask has all its cells");
  const int u0 = FirstPixel(box.u0, image_width), v0 = FirstPixel(box.v0, image_height);
  const int u1 = FirstPixel(box.u1, image_width), v1 = FirstPixel(box.v1, image_height);
  Mask mask{image_width, image_height, u0, v0, {}};
  if (u1 <= u0 || v1 <= v0) return {image_width, image_height, 0, 0, {}};
  mask.inside = Image<uint8_t>(u1 - u0, v1 - v0);
  const std::vector<Tap> columns = Taps(u0, u1, soft.scale_u, soft.offset_u, soft.width);
  const std::vector<Tap> rows = Taps(v0, v1, soft.scale_v, soft.offset_v, soft.height);
  for (int v = v0; v < v1; ++v) {
    FillRow(soft, rows[static_cast<size_t>(v - v0)], columns, threshold, mask.inside.row(v - v0));
  }
  return Tightened(mask);
}

}  // namespace vismap
